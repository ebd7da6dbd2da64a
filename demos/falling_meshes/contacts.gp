# SPDX-License-Identifier: BSD-3-Clause
# gnuplot -e "csv='IN.csv'; png='OUT.png'" contacts.gp: what `otg simulate --csv` wrote, as a picture.
set terminal pngcairo size 1200,860 font "DejaVu Sans,11" background rgb "white"
set output png
set datafile separator ","
set key top left samplen 2 textcolor rgb "#333333"
set grid lc rgb "#dddddd" lw 1
set border 3 lc rgb "#888888"
set tics nomirror textcolor rgb "#333333"
set lmargin 11
set rmargin 3
set multiplot layout 2,1 title "Falling meshes" font ",14"

# A step without contacts has no place on a logarithmic axis: it leaves a gap.
set ylabel "number in the step"
set logscale y
set yrange [0.8:*]
unset xlabel
plot csv using 2:9 skip 1 with lines lw 1.2 lc rgb "#7e9dc4" title "pairs of triangles that intersect", \
     csv using 2:3 skip 1 with lines lw 1.6 lc rgb "#c1440e" title "contacts (joints that ODE solves)"

set ylabel "milliseconds in the step"
set yrange [0.001:*]
set xlabel "simulated time in seconds"
plot csv using 2:5 skip 1 with lines lw 1.2 lc rgb "#1f5a9a" title "collision (dSpaceCollide)", \
     csv using 2:6 skip 1 with lines lw 1.2 lc rgb "#4f8f3a" title "ODE (dWorldQuickStep)"
unset multiplot
