NAME
ROWS
 N obj
 L r
COLUMNS
 x obj 1e30 r inf
RHS
 RHS r 1e20
ENDATA
