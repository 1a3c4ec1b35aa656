# shellcheck shell=bash
# The fixed wing over the chapter's box and Dubins sequence, in calm and in wind of half the airspeed, by the MPC and by
# the usual guidance.
rm -rf "$output"
mkdir -p "$output/report"
build/bin/fixedwing_figures --output "$output" > "$output/verdict.txt" || return
cat "$output/verdict.txt"

# drawFlight NAME TITLE: path, distance, roll and roll rate of both laws.
drawFlight() {
  gnuplot << PLOT
set terminal svg size 1100,760 font "sans,12" background "white"
set output "$output/report/$1.svg"
set datafile separator ","
set multiplot layout 2,2 title "$2"
set grid lc rgb "#dddddd"
set key outside top center horizontal
set xtics rotate by -45
set size ratio -1
set xlabel "east [m]"
set ylabel "north [m]"
plot "$output/$1_path.csv" using 2:1 with lines lc rgb "#bbbbbb" lw 4 title "path", \
     "$output/$1_l1.csv" every ::1 using 3:2 with lines lc rgb "#1f77b4" title "L1", \
     "$output/$1_mpc.csv" every ::1 using 3:2 with lines lc rgb "#d62728" lw 1.5 title "MPC"
set xtics norotate
set size noratio
set xlabel "time [s]"
set ylabel "distance from the path [m]"
plot "$output/$1_l1.csv" every ::1 using 1:4 with lines lc rgb "#1f77b4" title "L1", \
     "$output/$1_mpc.csv" every ::1 using 1:4 with lines lc rgb "#d62728" lw 1.5 title "MPC"
set ylabel "roll [deg]"
plot "$output/$1_mpc.csv" every ::1 using 1:6 with lines lc rgb "#999999" title "reference", \
     "$output/$1_mpc.csv" every ::1 using 1:5 with lines lc rgb "#d62728" title "roll"
set ylabel "roll rate [deg/s]"
plot "$output/$1_l1.csv" every ::1 using 1:7 with lines lc rgb "#1f77b4" title "L1", \
     "$output/$1_mpc.csv" every ::1 using 1:7 with lines lc rgb "#d62728" title "MPC"
PLOT
}

pictures=()
for figure in box dubins; do
  for air in calm wind; do
    drawFlight "${figure}_$air" "$figure, $air" || return
    drawFlight "${figure}_${air}_rough" "$figure, $air, an aircraft that the controller does not know, gusts" || return
    drawFlight "${figure}_${air}_six_dof" "$figure, $air, a rigid aircraft in six degrees of freedom, gusts" || return
    pictures+=("${figure}_$air" "${figure}_${air}_rough" "${figure}_${air}_six_dof")
  done
done
drawFlight tight_wind "Dubins planned for calm, in wind: arcs and a loiter that cannot be flown" || return
pictures+=(tight_wind)
# captionOf NAME: what a picture shows, in a sentence.
captionOf() {
  case $1 in
    *_six_dof) echo 'A rigid aircraft in six degrees of freedom, in gusts.' ;;
    *_rough) echo 'An aircraft that the controller does not know, in gusts.' ;;
    tight_wind) echo 'Turns planned for calm, in wind: they cannot be flown, and the roll is at its bound.' ;;
    *) echo 'The model that the controller predicts with.' ;;
  esac
}

{
  cat << 'HEAD'
<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Fixed wing</title><style>
body{font-family:sans-serif;max-width:1120px;margin:2em auto;padding:0 1em;color:#222;line-height:1.45}
h1{font-size:1.6em}h2{font-size:1.2em;margin-top:2em}img{max-width:100%}figure{margin:1.5em 0}
figcaption{color:#555}pre{background:#f4f4f4;padding:.8em;overflow-x:auto}
details{margin:1em 0}summary{cursor:pointer;font-weight:bold}
table{border-collapse:collapse;font-size:.9em;margin:1em 0;display:block;overflow-x:auto}
td,th{border:1px solid #ccc;padding:2px 8px;text-align:right}td:first-child{text-align:left}
</style></head><body>
<h1>The fixed wing over its figures</h1>
<p>Good is a distance from the path below 1 m on lines and loiters, and below 3 m on a Dubins sequence once it is joined: what
the chapter reports in calm. Red is the MPC, blue the usual L1 guidance.</p>
HEAD
  echo "<pre>$(cat "$output/verdict.txt")</pre>"
  for name in "${pictures[@]}"; do
    echo "<figure><img src=\"$name.svg\" alt=\"$name\"><figcaption>${name//_/ }: $(captionOf "$name")</figcaption></figure>"
  done
  echo '<details><summary>All numbers</summary>'
  cat "$output/tables.html"
  echo '</details></body></html>'
} > "$output/report/index.html"
