* a comment
NAME          all kinds
OBJSENSE
    MAX
ROWS
 N  cost
 L  most
 G  least
 E  same
 N  other
COLUMNS
    x         cost               2.5   most                 1
    x         least                1
    MARKER0   'MARKER'                 'INTORG'
    k         cost                -3   same                 1
    z         same                 2   most               1.5
    MARKER1   'MARKER'                 'INTEND'
    y         most               0.1   other                7
RHS
    RHS       cost                -7   most               1.1
    RHS       least               -1   same                 4
RANGES
    RANGE     most               2.3   same              -0.5
BOUNDS
 LO BOUND     x                 -1.5
 UP BOUND     x                    4
 BV BOUND     z
 UI BOUND     k                    9
 MI BOUND     y
QUADOBJ
    x         x                   -2
    x         y                    0
ENDATA
