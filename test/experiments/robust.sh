# shellcheck shell=bash
# The ASLquad over Figs. 10 to 13 of the chapter by the minimum-peak robust MPC, and beside it by the linear MPC (also with
# its disturbance estimate) and the LQR: turbulent wind on a helix, a hit on a slung load, a square ten times, a step.
rm -rf "$output"
mkdir -p "$output/report"
build/bin/robust_figures --problems region_maps/problems/robust --output "$output" || return

laws=(nominal lqr estimate robust)
colors=("#1f77b4" "#2ca02c" "#ff7f0e" "#d62728")
dashes=(1 2 1 1)  # LQR and linear MPC are one where no bound is active
names=("linear MPC" "LQR" "linear MPC, disturbance estimate" "robust MPC")

# curves FIGURE USING: a curve for each law.
curves() {
  local i line=""
  for i in "${!laws[@]}"; do
    line+=", \"$output/$1_${laws[i]}.csv\" every ::1 using $2 with lines lc rgb \"${colors[i]}\" dt ${dashes[i]} title \"${names[i]}\""
  done
  echo "${line:2}"
}
reference() { echo "\"$output/$1_robust.csv\" every ::1 using $2 with lines lc rgb \"#999999\" dt 2 lw 2 title \"reference\""; }

# draw FIGURE TITLE LAYOUT: reads plot commands.
draw() {
  {
    echo "set terminal svg size 1100,860 font \"sans,12\" background \"white\""
    echo "set output \"$output/report/$1.svg\""
    echo "set datafile separator \",\""
    echo "set multiplot layout $3 title \"$2\""
    echo "set grid lc rgb \"#dddddd\""
    cat
  } | gnuplot
}

draw helix "Fig. 10: helix in turbulent wind from one side" 2,2 << PLOT || return
set xlabel "x [m]"
set ylabel "y [m]"
set zlabel "z [m]"
set key top left
splot $(reference helix 5:6:7), "$output/helix_robust.csv" every ::1 using 2:3:4 with lines lc rgb "#d62728" title "robust MPC"
set xlabel "time [s]"
set ylabel "error along x [m]"
plot $(curves helix "1:(\$2-\$5)")
set ylabel "error along y, down the wind [m]"
plot $(curves helix "1:(\$3-\$6)")
set ylabel "error along z [m]"
plot $(curves helix "1:(\$4-\$7)")
PLOT
draw hit "Fig. 11: hover with a slung load, hit at t = 3 s" 2,2 << PLOT || return
set xlabel "time [s]"
set ylabel "x [m]"
plot $(curves hit 1:2)
set ylabel "y [m]"
plot $(curves hit 1:3)
set ylabel "load below the vehicle, along y [m]"
plot $(curves hit "1:(\$16-\$3)")
set ylabel "roll [rad]"
plot "$output/hit_robust.csv" every ::1 using 1:13 with steps lc rgb "#bbbbbb" title "command", \
     "$output/hit_robust.csv" every ::1 using 1:11 with lines lc rgb "#d62728" title "robust MPC"
PLOT
draw square "Fig. 12: a square, ten times, with the slung load" 2,2 << PLOT || return
set size ratio -1
set xlabel "x [m]"
set ylabel "y [m]"
plot $(reference square 5:6), "$output/square_robust.csv" every ::1 using 2:3 with lines lc rgb "#d62728" title "robust MPC"
plot $(reference square 5:6), "$output/square_nominal.csv" every ::1 using 2:3 with lines lc rgb "#1f77b4" title "linear MPC"
set size noratio
set xlabel "time [s]"
set ylabel "error along x [m]"
plot $(curves square "1:(\$2-\$5)")
set ylabel "error along y [m]"
plot $(curves square "1:(\$3-\$6)")
PLOT
draw step "Fig. 13: a step of 1.25 m to the side with the slung load" 2,2 << PLOT || return
set key bottom right
set xlabel "time [s]"
set ylabel "y [m]"
plot $(reference step 1:6), $(curves step 1:3)
set ylabel "speed along y [m/s]"
plot $(curves step 1:9)
set ylabel "roll [rad]"
plot $(curves step 1:11)
set ylabel "load below the vehicle, along y [m]"
plot $(curves step "1:(\$16-\$3)")
PLOT
{
  echo '<!DOCTYPE html><html><head><meta charset="utf-8"><title>Robust MPC</title><style>body{font-family:sans-serif}'
  echo 'table{border-collapse:collapse}td,th{border:1px solid #ccc;padding:2px 8px;text-align:right}</style></head><body>'
  echo '<h1>The ASLquad over Figs. 10 to 13</h1>'
  cat "$output/tables.html"
  echo '</body></html>'
} > "$output/report/index.html"
