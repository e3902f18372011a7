NAME
ROWS
 N obj
 L r1
 E r2
COLUMNS
 x obj 1 r1 1
 y obj -1 r1 1
 S1 s1 'MARKER' 'SOSORG'
 a obj 1 r2 1
 b obj 1 r2 1
 S1 s1 'MARKER' 'SOSEND'
 z obj 1 r2 1
RHS
 r1 4
 RHS r2 1
BOUNDS
 UP BND x 5
 UP BND y 5
 BV BND z
 FR BND a
SOS
 S2 two
 x 1
 y 2
SOS1
 S1 SOS one 3
 SOS a 0.5
 SOS b -1 $ comment
INDICATORS
 IF r1 z 1
ENDATA
