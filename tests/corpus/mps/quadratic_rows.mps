NAME          rows
ROWS
 N  obj
 L  plain
 L  square
 G  concave
COLUMNS
    x         obj                  1   square              -4
    y         obj                  2
    h         obj                  0
RHS
    RHS       square              -1   concave           -9
BOUNDS
 LO BOUND     x                   -1
QCMATRIX   plain
    x         x                    1
    y         y                  0.3
    h         h                   -1
QSECTION   concave
    x         x                   -2
    y         x                    1
    y         y                   -4
QCMATRIX   square
    x         x                    1
    x         y                  0.1
    y         x                  0.1
    y         y                    1
ENDATA
