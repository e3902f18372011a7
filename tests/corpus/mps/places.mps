NAME places
ROWS
 N c
 L r
 G s
COLUMNS
 x c 1 r 2
 y c 3 r 4
 x s 5
 y s 6
 z s 1
RHS
 B r 9 s 1
ENDATA
