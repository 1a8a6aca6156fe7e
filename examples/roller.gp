size = '1800,600'; set terminal pngcairo size 1800,600 font 'DejaVu Sans,11'; set output 'roller.png'
set encoding utf8; set style line 1 lw 3 lc rgb '#0072B2'
set style line 2 lw 2.5 dt (10,8) lc rgb '#D55E00'
set style line 3 lw 1.3 lc rgb '#000000'
set style line 4 lw 1 pt 6 ps 0.8 lc rgb '#707070'
set style line 5 lw 1 pt 9 ps 1.1 lc rgb '#E69F00'
set style line 6 lw 1 pt 5 ps 0.8 lc rgb '#009E73'
set style line 7 lw 0.6 lc rgb '#7FB2D6'
set style line 8 lw 2.5 dt (8,6) lc rgb '#CC79A7'
set grid back lt 1 lw 0.8 lc rgb '#d0d0d0'; set autoscale fix
set key bmargin center horizontal Left reverse samplen 3 width 1; set bmargin 7
set offsets graph 0.03, graph 0.03, graph 0.06, graph 0.06
obstacle = 'roller_obstacle.txt'
set multiplot title 'NAFEMS CB1: steel roller, the slave, on an aluminium block'
set size ratio -1; set title 'in true scale, P2'; set xlabel 'x [mm]'; set ylabel 'y [mm]'
outline = '< cat "roller_outline.txt" "roller_block_outline.txt"'; field = '< cat "roller_map.txt" "roller_block_map.txt"'; arrows = '< cat "roller_arrows.txt" "roller_block_arrows.txt"'
stats outline using 1 nooutput name 'A'; stats outline using 3 nooutput name 'B'
stats outline using 2 nooutput name 'C'; stats outline using 4 nooutput name 'D'
least(p, q) = p < q ? p : q; most(p, q) = p > q ? p : q; left = least(A_min, B_min)
right = most(A_max, B_max); below = least(C_min, D_min); above = most(C_max, D_max)
set cbrange [0:*]; set palette defined (0 '#ffffff', 0.5 '#a6cde8', 1 '#3a7ab8')
left = 0; right = 20; below = -15; above = 13
T_max = 0; stats arrows using (sqrt($3**2 + $4**2)) nooutput name 'T'
m = 0.035*sqrt((right - left)**2 + (above - below)**2)
set xrange [left-m:right+m]; set yrange [below-m:above+m]
R = T_max > 0 ? most(T_up_quartile, T_max/2.5) : 1; k = 2.9*m/R; o = 10**floor(log10(R))
R = R < 2*o ? o : R < 5*o ? 2*o : 5*o; comma = strstrt(size, ',')
s = least(0.33/(right - left + 2*m), 0.68*size[comma+1:*]/size[1:comma-1]/(above - below + 2*m))
if (T_max > 0) {set arrow 9 from screen 0.08,0.03 to screen 0.08+k*R*s,0.03 filled head size screen 0.006,20 lw 1.3 lc rgb '#000000'
set label 9 sprintf('traction on the body, %g MPa', R) at screen 0.09+k*R*s,0.03}
set lmargin at screen 0.07; set rmargin at screen 0.4
set tmargin at screen 0.88; set bmargin at screen 0.2
set key at screen 0.25,0.075 center vertical maxrows 1
set object 1 rectangle from graph 0,0 to graph 1,1 front fillstyle empty border lc rgb '#000000'
set view map; unset grid; set cblabel 'von Mises [MPa]' offset 1.5,0; set colorbox
stats field using 1:2 nooutput name 'F'
q = F_records < 4000 ? 12 : F_records < 40000 ? 4 : 2; set pm3d interpolate q,q
splot field using 1:2:3 with pm3d notitle, field using 1:2:3 with pm3d notitle, outline using 3:4:(0) with lines lw 1.3 lc rgb '#000000' title 'deformed', outline using 1:2:(0) with lines lw 1.2 dt (5,4) lc rgb '#000000' title 'undeformed', outline using ($5==1?$3:1/0):4:(0) with lines lw 4 lc rgb '#D55E00' title 'contact boundary', obstacle using 1:2:(0) with lines lw 1.5 lc rgb '#000000' notitle, arrows using 1:2:(0):(k*$3):(k*$4):(0) with vectors filled head size screen 0.006,20 lw 1.3 lc rgb '#000000' notitle
unset object 1; unset arrow 9; unset label 9; unset colorbox; set grid back lt 1 lw 0.8 lc rgb '#d0d0d0'
set autoscale; set autoscale fix
unset lmargin; unset rmargin; unset tmargin; set bmargin 7; unset key
set key bmargin center horizontal Left reverse samplen 3 width 1
set tmargin at screen 0.88; set bmargin at screen 0.2
set lmargin at screen 0.53; set rmargin at screen 0.73; set key at screen 0.63,0.05 center vertical maxrows 1
set size noratio; set title 'pressure of the contact, a/h = 8'; set xlabel 'x/a'; set ylabel 'p/p0'
set samples 2000
plot [0:1.3] [0:1.1] x < 1 ? sqrt(1 - x*x) : 0 with lines ls 2 title 'Hertz', 'roller_P1_8.txt' with points ls 4 title 'P1', 'roller_P2_8.txt' with points ls 5 title 'P2'
set lmargin at screen 0.8; set rmargin at screen 0.98; set key at screen 0.89,0.06 center vertical maxrows 2
set title 'errors of the fit to the nodes'; set xlabel 'a/h'; set ylabel 'error [%]'; set logscale xy; set xtics (4, 8, 16)
plot [3.5:9.2] 'roller_errors.txt' index 0 using 1:2 with linespoints ls 1 pt 6 title 'p0, P1', '' index 0 using 1:3 with linespoints ls 2 pt 6 title 'a, P1', '' index 1 using 1:2 with linespoints ls 1 pt 5 title 'p0, P2', '' index 1 using 1:3 with linespoints ls 2 pt 5 title 'a, P2'
unset multiplot
