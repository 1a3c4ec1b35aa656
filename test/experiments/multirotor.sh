# shellcheck shell=bash
# Figs. 7 and 8 of the chapter: the multirotor on an aggressive and on a more aggressive trajectory at 100 Hz, all laws over
# each other.
rm -rf "$output"
mkdir -p "$output/report"
solveAxes > /dev/null || return
build/bin/multirotor_figures --maps build/demo/maps --problems region_maps/problems --output "$output" || return

# curves FIGURE USING [REFERENCE]: a curve for each law, the dashed ones over what they hide, and the reference.
curves() {
  local using=$2
  [ -z "${3:-}" ] || printf '"%s/%s_linear.csv" every 4::1 using %s with lines lc rgb "#999999" lw 4 title "reference", ' "$output" "$1" "$3"
  printf '"%s/%s_linear.csv" every 4::1 using %s with lines lc rgb "#1f77b4" lw 2 title "linear", ' "$output" "$1" "$using"
  printf '"%s/%s_explicit_linear.csv" every 4::1 using %s with lines lc rgb "#2ca02c" dt 2 lw 2 title "explicit linear", ' \
    "$output" "$1" "$using"
  printf '"%s/%s_nonlinear.csv" every 4::1 using %s with lines lc rgb "#d62728" title "nonlinear"\n' "$output" "$1" "$using"
}

# drawFigure NAME TITLE: position, velocity, attitude and error over time, in the chapter's order.
drawFigure() {
  gnuplot << PLOT || return
set terminal svg size 1300,1100 font "sans,12" background "white"
set output "$output/report/$1.svg"
set datafile separator ","
set multiplot layout 4,3 title "$2"
set grid lc rgb "#dddddd"
set xlabel "time [s]"
set key off
set ylabel "x [m]"
plot $(curves "$1" 1:2 1:5)
set ylabel "y [m]"
plot $(curves "$1" 1:3 1:6)
set key top right
set ylabel "z [m]"
plot $(curves "$1" 1:4 1:7)
set key off
set ylabel "velocity along x [m/s]"
plot $(curves "$1" 1:8 1:11)
set ylabel "velocity along y [m/s]"
plot $(curves "$1" 1:9 1:12)
set ylabel "velocity along z [m/s]"
plot $(curves "$1" 1:10 1:13)
set ylabel "roll [deg]"
plot $(curves "$1" '1:($14*57.29578)')
set ylabel "pitch [deg]"
plot $(curves "$1" '1:($15*57.29578)')
set ylabel "yaw [deg]"
plot $(curves "$1" '1:($16*57.29578)' '1:($17*57.29578)')
set ylabel "error along x [m]"
plot $(curves "$1" '1:($2-$5)')
set ylabel "error along y [m]"
plot $(curves "$1" '1:($3-$6)')
set ylabel "error along z [m]"
plot $(curves "$1" '1:($4-$7)')
PLOT
}

drawFigure fig7 "Fig. 7: aggressive trajectory" || return
drawFigure fig8 "Fig. 8: more aggressive trajectory" || return
cat > "$output/report/index.html" << HTML
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Multirotor: Figs. 7 and 8</title>
<style>body{font-family:sans-serif;max-width:85em;margin:2em auto}td,th{padding:.2em .8em;text-align:right}td:first-child,td:nth-child(2){text-align:left}img{max-width:100%}</style>
</head><body><h1>The laws of the multirotor on the trajectories of Figs. 7 and 8</h1>
<p>Simulated Firefly at 100 Hz, with the noise and the air of a laboratory; the same flight for every law.</p>
<table><tr><th>flight</th><th>law</th><th>position, rms [m]</th><th>greatest [m]</th><th>velocity, rms [m/s]</th><th>yaw, rms [rad]</th><th>speed [m/s]</th><th>tilt [deg]</th><th>samples without an optimum</th></tr>
$(cat "$output/table.html")
</table>
<img src="fig7.svg" alt="Fig. 7"><img src="fig8.svg" alt="Fig. 8">
</body></html>
HTML
