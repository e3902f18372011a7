// Written by `tests/table.rs`: states that a search of carom has solved.
// Position (m), speed (m/s), and the least cost; null where no plan exists.
export const SOLVED = [
  [-0.8, 0.6, 3.2036],
  [0.3, 0.9, 4.8726],
  [0.6, 0.4, 4.6212],
  [0.7, -0.5, 3.2576],
  [0.9, 0.9, null],
];
