//! Small integer programs that are answered by trying all points, and proofs of that for the
//! checker.

use std::fmt::Write as _;

/// A row: sides and coefficients.
pub(crate) type Row = (Option<i64>, Option<i64>, Vec<i64>);

/// Minimise `linear x + sum squares_j x_j²` over whole x within bounds, rows and a cone.
#[derive(Debug, Clone)]
pub(crate) struct Small {
    pub(crate) bounds: Vec<(i64, i64)>,
    pub(crate) rows: Vec<Row>,
    /// `x_head >= |(x_j for j in tail)|`, or `x_head x_second >= |(x_j for j in tail)|²`.
    pub(crate) cone: Option<(usize, Option<usize>, Vec<usize>)>,
    pub(crate) linear: Vec<i64>,
    pub(crate) squares: Vec<i64>,
    /// `None` claims that there is no point.
    pub(crate) claim: Option<f64>,
}

impl Small {
    /// The least objective of all points, by trying them all.
    pub(crate) fn best(&self) -> Option<i64> {
        self.best_from(&mut Vec::new())
    }

    fn best_from(&self, x: &mut Vec<i64>) -> Option<i64> {
        let Some(&(lower, upper)) = self.bounds.get(x.len()) else {
            let fits = self.violated_row(x).is_none() && self.violated_cone(x).is_none();
            return fits.then(|| self.objective(x));
        };
        let mut best = None;
        for value in lower..=upper {
            x.push(value);
            let found = self.best_from(x);
            x.pop();
            best = [best, found].into_iter().flatten().min();
        }
        best
    }

    /// Whether the claim is true.
    pub(crate) fn is_true(&self) -> bool {
        match (self.claim, self.best()) {
            (_, None) => true,
            (None, Some(_)) => false,
            (Some(bound), Some(best)) => best as f64 >= bound,
        }
    }

    fn objective(&self, x: &[i64]) -> i64 {
        let squares = x.iter().zip(&self.squares).map(|(x, a)| a * x * x);
        dot(&self.linear, x) + squares.sum::<i64>()
    }

    /// A row that a point violates, and whether it does so with its upper side.
    fn violated_row(&self, x: &[i64]) -> Option<(usize, bool)> {
        self.rows.iter().enumerate().find_map(|(k, (lower, upper, row))| {
            let value = dot(row, x);
            let is_above = upper.is_some_and(|upper| value > upper);
            let is_below = lower.is_some_and(|lower| value < lower);
            (is_above || is_below).then_some((k, is_above))
        })
    }

    /// The heads and the tail of the cone, if a point violates it.
    fn violated_cone(&self, x: &[i64]) -> Option<(i64, i64, Vec<i64>)> {
        let (head, second, tail) = self.cone.as_ref()?;
        let tail: Vec<i64> = tail.iter().map(|&j| x[j]).collect();
        let squares: i64 = tail.iter().map(|v| v * v).sum();
        let (a, b) = (x[*head], x[second.unwrap_or(*head)]);
        (a < 0 || b < 0 || a * b < squares).then_some((a, b, tail))
    }

    pub(crate) fn header(&self) -> String {
        let mut log = format!("carom proof 1\nsense min\ncolumns {}\n", self.bounds.len());
        for (j, (lower, upper)) in self.bounds.iter().enumerate() {
            let _ = writeln!(log, "c i {lower} {upper} x{j}");
        }
        let _ = writeln!(log, "rows {}", self.rows.len());
        for (lower, upper, row) in &self.rows {
            let side = |side: &Option<i64>| side.map(|side| side.to_string());
            let lower = side(lower).unwrap_or("-inf".into());
            let upper = side(upper).unwrap_or("inf".into());
            let _ = writeln!(log, "r {lower} {upper} {}", entries(row));
        }
        let _ = writeln!(log, "cones {}", usize::from(self.cone.is_some()));
        if let Some((head, second, tail)) = &self.cone {
            let tail: Vec<String> = tail.iter().map(|j| format!(" {j}")).collect();
            let heads = match second {
                Some(second) => format!("r {head} {second}"),
                None => format!("q {head}"),
            };
            let _ = writeln!(log, "{heads} {}{}", tail.len(), tail.concat());
        }
        let squares: Vec<String> = (0..self.squares.len())
            .filter(|&j| self.squares[j] != 0)
            .map(|j| format!(" {j} {j} {}", 2 * self.squares[j]))
            .collect();
        let _ = writeln!(log, "objective 0\ng {}", entries(&self.linear));
        let _ = writeln!(log, "h {}{}", squares.len(), squares.concat());
        match self.claim {
            Some(bound) => log + &format!("claim bound {bound}\nproof\n"),
            None => log + "claim infeasible\nproof\n",
        }
    }
}

fn dot(a: &[i64], b: &[i64]) -> i64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn entries(values: &[i64]) -> String {
    let pairs: Vec<String> = values.iter().enumerate().map(|(j, v)| format!(" {j} {v}")).collect();
    format!("{}{}", values.len(), pairs.concat())
}

/// Writes proofs: all columns are split until they are fixed, and each point is refuted. `choices`
/// decide in which of several ways.
pub(crate) struct Writer<'a> {
    small: &'a Small,
    choices: &'a [u8],
    used: usize,
    facts: usize,
    pub(crate) lines: Vec<String>,
}

impl<'a> Writer<'a> {
    pub(crate) fn new(small: &'a Small, choices: &'a [u8]) -> Self {
        let mut writer =
            Writer { small, choices, used: 0, facts: small.rows.len(), lines: Vec::new() };
        let products = if writer.choice(2) == 0 { zero_products(small) } else { Vec::new() };
        let products: Vec<Product> =
            products.into_iter().filter(|_| writer.choice(2) == 0).collect();
        writer.write(&products);
        writer
    }

    /// A proof that adds these products to the objective, whether they are 0 or not.
    pub(crate) fn with_products(small: &'a Small, choices: &'a [u8], products: &[Product]) -> Self {
        let mut writer =
            Writer { small, choices, used: 0, facts: small.rows.len(), lines: Vec::new() };
        writer.write(products);
        writer
    }

    fn choice(&mut self, many: u8) -> u8 {
        self.used += 1;
        self.choices[self.used % self.choices.len()] % many
    }

    fn line(&mut self, line: String) {
        self.lines.push(line);
    }

    fn fact(&mut self, line: String) -> usize {
        self.line(line);
        self.facts += 1;
        self.facts - 1
    }

    fn write(&mut self, products: &[Product]) {
        match products.is_empty() {
            true => self.convexity(),
            false => self.products(products),
        }
        let mut bounds = self.small.bounds.clone();
        self.tree(&mut bounds);
        let steps = self.lines.len();
        self.line(format!("end {steps}"));
    }

    /// Adds products to the objective, and proves that it is convex up to what they take from it.
    fn products(&mut self, products: &[Product]) {
        let mut deficits = vec![0.0; self.small.bounds.len()];
        let mut line = format!("e {}", products.len());
        for (column, value, binary, off, bounds) in products {
            let factor = f64::from(self.choice(9)) / 2.0 - 2.0;
            deficits[*column] += 2.0 * factor.abs();
            deficits[*binary] += 2.0 * factor.abs();
            let _ = write!(line, " {column} {value} {binary} {off} {factor} {}", bounds.len());
            bounds.iter().for_each(|bound| line.push_str(bound));
        }
        self.line(line);
        let deficits: Vec<String> =
            deficits.iter().enumerate().map(|(j, d)| format!(" {j} {d}")).collect();
        self.line(format!("p {}{}", deficits.len(), deficits.concat()));
        self.line("l 0".into());
    }

    /// Proves convexity, and bounds from it around a point.
    fn convexity(&mut self) {
        let Small { squares, linear, bounds, claim, .. } = self.small;
        let steep: Vec<usize> = (0..squares.len()).filter(|&j| squares[j] != 0).collect();
        let Some(limit) = claim.filter(|_| self.choice(2) == 0) else {
            self.line("p 0".into());
            return self.line("l 0".into());
        };
        let deficits: Vec<String> =
            steep.iter().map(|&j| format!(" {j} {}", -2 * squares[j])).collect();
        self.line(format!("p {}{}", deficits.len(), deficits.concat()));
        self.line("l 0".into());
        let point: Vec<i64> = bounds
            .iter()
            .map(|(lower, upper)| lower + i64::from(self.choice((upper - lower + 1) as u8)))
            .collect();
        let slopes: Vec<f64> =
            (0..point.len()).map(|j| (linear[j] + 2 * squares[j] * point[j]) as f64).collect();
        // The least of each term of the objective around the point.
        let least = |j: usize| match squares[j] {
            0 if slopes[j] < 0.0 => slopes[j] * (bounds[j].1 - point[j]) as f64,
            0 => slopes[j] * (bounds[j].0 - point[j]) as f64,
            square => -slopes[j] * slopes[j] / (4 * square) as f64 - 0.125,
        };
        let all: f64 =
            (0..point.len()).map(least).sum::<f64>() + self.small.objective(&point) as f64;
        let mut found = Vec::new();
        for j in 0..point.len() {
            for (side, step) in [("U", 1), ("L", -1)] {
                let mut value = point[j];
                while (bounds[j].0..=bounds[j].1).contains(&value) {
                    let x = (value - point[j]) as f64;
                    let curvature = squares[j] as f64;
                    let growth = slopes[j] + 2.0 * curvature * x;
                    let grows = growth * step as f64 >= 0.0;
                    let term = slopes[j] * x + curvature * x * x;
                    if grows && all - least(j) + term >= limit {
                        found.push(format!(" {j} {side} {value}"));
                        break;
                    }
                    value += step;
                }
            }
        }
        let values: Vec<String> =
            point.iter().enumerate().map(|(j, x)| format!(" {j} {x}")).collect();
        let falls: Vec<String> = steep.iter().map(|&j| format!(" {j} {}", -least(j))).collect();
        let lists = [values, falls, found].map(|list| format!("{}{}", list.len(), list.concat()));
        self.line(format!("w {}", lists.join(" ")));
    }

    /// Refutes all points within bounds.
    fn tree(&mut self, bounds: &mut Vec<(i64, i64)>) {
        if let Some(j) = bounds.iter().position(|(lower, upper)| lower > upper) {
            self.line(format!("d {j}"));
            return;
        }
        let Some(j) = bounds.iter().position(|(lower, upper)| lower < upper) else {
            let x: Vec<i64> = bounds.iter().map(|b| b.0).collect();
            return self.point(&x);
        };
        let (lower, upper) = bounds[j];
        let value = lower + i64::from(self.choice((upper - lower) as u8));
        let is_form = self.choice(2) == 0;
        self.line(if is_form { format!("f {value} 1 {j} 1") } else { format!("s {j} {value}") });
        for (side, limits) in [("U", (lower, value)), ("L", (value + 1, upper))] {
            let facts = self.facts;
            if is_form {
                let bound = if side == "U" { value } else { value + 1 };
                self.facts += 1;
                self.line(format!("b {j} {side} {bound} {facts}"));
            }
            bounds[j] = limits;
            self.tree(bounds);
            self.facts = facts;
        }
        bounds[j] = (lower, upper);
    }

    fn point(&mut self, x: &[i64]) {
        if let Some((row, is_above)) = self.small.violated_row(x) {
            return self.row(row, is_above, x);
        }
        if let Some((a, b, tail)) = self.small.violated_cone(x) {
            return self.cone(a as f64, b as f64, &tail);
        }
        let point: Vec<String> =
            x.iter().enumerate().map(|(j, value)| format!(" {j} {value}")).collect();
        let tangent = self.fact(format!("t {}{}", point.len(), point.concat()));
        if self.choice(2) == 0 {
            self.line(format!("x 1 {tangent} -1"));
        } else {
            let fact = self.fact(format!("k 1 {tangent} -1"));
            self.line(format!("x 1 {fact} 1.5"));
        }
    }

    /// Refutes a point with a cone that it violates.
    fn cone(&mut self, a: f64, b: f64, tail: &[i64]) {
        let is_rotated = self.small.cone.as_ref().is_some_and(|cone| cone.1.is_some());
        let (p, q) = match (is_rotated, a < 0.0, b < 0.0) {
            (false, ..) => (1.0, 1.0),
            (true, true, _) => (1.0, 0.0),
            (true, _, true) => (0.0, 1.0),
            _ => (b + 1e-3, a + 1e-3),
        };
        // A bit shorter than allowed where it must be rounded.
        let norm = tail.iter().map(|v| (v * v) as f64).sum::<f64>().sqrt();
        let scale = if norm == 0.0 { 0.0 } else { (p * q).sqrt() / norm * (1.0 - 1e-14) };
        let w: Vec<String> = tail.iter().map(|&v| format!(" {}", v as f64 * scale)).collect();
        let heads = if is_rotated { format!("{p} {q}") } else { "1".to_string() };
        let fact = self.fact(format!("q 0 {heads} {}{}", tail.len(), w.concat()));
        self.line(format!("x 1 {fact} 1"));
    }

    /// Refutes a point with a row that it violates.
    fn row(&mut self, row: usize, is_above: bool, x: &[i64]) {
        let sign = if is_above { -1 } else { 1 };
        let entries = &self.small.rows[row].2;
        let Some(j) = entries.iter().position(|&value| value != 0) else {
            return self.line(format!("x 1 {row} {sign}"));
        };
        let is_upper = (entries[j] > 0) == is_above;
        // A bound beyond the value at which the column is fixed.
        let (side, bound) = if is_upper { ("U", x[j] - 1) } else { ("L", x[j] + 1) };
        match self.choice(3) {
            0 => self.line(format!("x 1 {row} {sign}")),
            1 => {
                self.line(format!("b {j} {side} {bound} {row}"));
                self.line(format!("d {j}"));
            }
            _ => {
                self.line(format!("m {side} {bound} 1 {j} 1"));
                self.line(format!("x 1 {row} {sign}"));
                let fact = self.facts;
                self.facts += 1;
                self.line(format!("b {j} {side} {bound} {fact}"));
                self.line(format!("d {j}"));
            }
        }
    }
}

/// A column, its value while a binary is off, the binary, where that is, and the bounds that say
/// so.
pub(crate) type Product = (usize, i64, usize, i64, Vec<String>);

/// All products that are 0 by the bounds and one row for each side of the column.
fn zero_products(small: &Small) -> Vec<Product> {
    let mut all = Vec::new();
    let binaries = (0..small.bounds.len())
        .filter(|&j| small.bounds[j].0 >= 0 && small.bounds[j].1 <= 1)
        .flat_map(|j| [(j, 0), (j, 1)]);
    for (binary, off) in binaries {
        let mut bounds = small.bounds.clone();
        bounds[binary] = (bounds[binary].0.max(off), bounds[binary].1.min(off));
        for column in 0..bounds.len() {
            let (mut own, mut facts) = (bounds[column], [None, None]);
            for (k, (lower, upper, row)) in small.rows.iter().enumerate() {
                let a = row[column];
                // Each side as an upper one.
                for (sign, side) in [(1, *upper), (-1, lower.map(|lower| -lower))] {
                    let (Some(side), true) = (side, a != 0) else { continue };
                    let others = (0..row.len()).filter(|&j| j != column);
                    let least = |j: usize| {
                        let (lower, upper) = bounds[j];
                        (sign * row[j] * lower).min(sign * row[j] * upper)
                    };
                    let (a, left) = (sign * a, side - others.map(least).sum::<i64>());
                    if a > 0 && left.div_euclid(a) < own.1 {
                        (own.1, facts[1]) = (left.div_euclid(a), Some(k));
                    }
                    if a < 0 && -left.div_euclid(-a) > own.0 {
                        (own.0, facts[0]) = (-left.div_euclid(-a), Some(k));
                    }
                }
            }
            if own.0 == own.1 {
                let sides = facts.iter().zip([("L", own.0), ("U", own.1)]);
                let bound = |(fact, (side, value)): (&Option<usize>, _)| {
                    fact.map(|fact| format!(" {column} {side} {value} {fact}"))
                };
                all.push((column, own.0, binary, off, sides.filter_map(bound).collect()));
            }
        }
    }
    all
}
