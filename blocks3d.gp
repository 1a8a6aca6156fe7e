set terminal pngcairo size 1400,680 font 'DejaVu Sans,11'; set output 'blocks3d.png'
set encoding utf8; set style line 1 lw 3 lc rgb '#0072B2'
set style line 2 lw 2.5 dt (10,8) lc rgb '#D55E00'
set style line 3 lw 1.3 lc rgb '#000000'
set style line 4 lw 1 pt 6 ps 0.8 lc rgb '#707070'
set style line 5 lw 1 pt 9 ps 1.1 lc rgb '#E69F00'
set style line 6 lw 1 pt 5 ps 0.8 lc rgb '#009E73'
set style line 7 lw 0.6 lc rgb '#7FB2D6'
set grid back lt 1 lw 0.8 lc rgb '#d0d0d0'; set autoscale fix
set key bmargin center horizontal Left reverse samplen 3 width 1; set bmargin 7
set offsets graph 0.03, graph 0.03, graph 0.06, graph 0.06
contact = 'blocks3d_contact.txt'; lines = 'blocks3d_lines.txt'; a = 1; b = 2
s = 1; set multiplot title "frictionCG: block on a block, turned by 20 degrees, mu = 0.5"
stats contact using a nooutput name 'A'; stats contact using b nooutput name 'B'; stats contact using 6 nooutput name 'L'
m = 0.04*(A_max - A_min); set xrange [A_min-m:A_max+m]
m = 0.04*(B_max - B_min); set yrange [B_min-m:B_max+m]
set object 1 rectangle from graph 0,0 to graph 1,1 front fillstyle empty border lc rgb '#000000'
set view map; set size ratio -1; unset grid; set pm3d interpolate 4,4
set palette defined (0 '#ffffff', 0.5 '#8fc1e3', 1 '#0b3c6f')
set xlabel 'x [mm]'; set ylabel 'y [mm]'
marks = "lines using a:b:(0) with lines lw 2.5 lc rgb '#D55E00' title 'between two states', contact using a:b:($7==1?0:1/0) with points ls 4 ps s title 'separated', contact using a:b:($7==2?0:1/0) with points ls 5 ps s title 'slip', contact using a:b:($7==3?0:1/0) with points ls 6 ps s title 'stick'"
set tmargin at screen 0.88; set bmargin at screen 0.2
set key at screen 0.5,0.05 center vertical maxrows 1
set lmargin at screen 0.06; set rmargin at screen 0.42
set title 'pressure [MPa]'
eval 'splot contact using a:b:4 with pm3d notitle, '.marks
set lmargin at screen 0.56; set rmargin at screen 0.92; unset key
set title '|shear| over its bound'; set cbrange [0:1]
eval 'splot contact using a:b:($6>1e-9*L_max?$5/$6:0) with pm3d notitle, '.marks
unset multiplot
