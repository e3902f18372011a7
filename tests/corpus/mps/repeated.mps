NAME
ROWS
 N obj
 L c
 L c2
COLUMNS
 x obj 1 c 1
 x c 2
RHS
 A c 1
 B c 2
 A none 3
RANGES
 A c 1
 A obj 2
BOUNDS
 UP A x 3
 UP A x 4
 UP B x 5
 PL A y
ENDATA
