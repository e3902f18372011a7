NAME          names with blanks
ROWS
 N  COST
 L  LIM ONE
COLUMNS
    X ONE     COST               1.0   LIM ONE            1.0
    Y         COST               2.0   LIM ONE            1.0
RHS
    RHS       LIM ONE            4.0
BOUNDS
 UP BND       X ONE              4.0
ENDATA
