NAME
ROWS
 N obj
 G r1
 L r2
COLUMNS
 x obj 1 r1 1
 x r2 1
 y obj 3 r1 1
 M 'MARKER' 'INTORG'
 k r1 2
 n r2 1
 M 'MARKER' 'INTEND'
RHS
 R r1 0.5 r2 2
BOUNDS
 LO B x 0.0125
 SC B x 0.00668
 SC B k 5
 LO B n 2
 SI B n 7.5
 UP B y -1
ENDATA
