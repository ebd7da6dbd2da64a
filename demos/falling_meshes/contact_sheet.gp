# SPDX-License-Identifier: BSD-3-Clause
# gnuplot -e "pictures='frame_%d.png'; times='0.2 0.5 ...'; png='OUT.png'" contact_sheet.gp: six pictures of 960 x 540
# pixels on one sheet, each with its time.
set terminal pngcairo size 1440,540 font "DejaVu Sans,12"
set output png
set multiplot
unset border
unset tics
unset key
set lmargin 0
set rmargin 0
set tmargin 0
set bmargin 0
set xrange [0:959]
set yrange [0:539]
gap = 0.004
do for [i = 0:5] {
  set size 1.0/3 - gap, 1.0/2 - gap
  set origin (i % 3) / 3.0 + gap/2, (1 - i / 3) / 2.0 + gap/2
  set label 1 word(times, i + 1)." s" at graph 0.03, graph 0.92 textcolor rgb "#20303f" front
  plot sprintf(pictures, i + 1) binary filetype=png with rgbimage
}
unset multiplot
