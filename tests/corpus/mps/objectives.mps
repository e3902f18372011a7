NAME
OBJNAME
 second
OBJSENSE MIN
ROWS
 N first
 N second
 G c
COLUMNS
 x first 1 second 2
 x c 1
 y second 1D0
RHS
 RHS second 1e-300 c -0.0
QMATRIX
 x x 2
 x y 1
 y x 1
 y y 3
ENDATA
