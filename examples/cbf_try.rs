use carom::model::{Quadratic, norm};
use carom::prelude::*;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap();
    let limit: f64 = std::env::args().nth(2).and_then(|s| s.parse().ok()).unwrap_or(20.0);
    let text = std::fs::read_to_string(&path)?;
    let mut t = text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#'));
    let mut m = Model::new("m");
    let (mut max, mut vars, mut ints, mut cons) = (false, vec![], vec![], vec![]);
    let (mut obj, mut obj0, mut a, mut b) = (vec![], 0.0, vec![], vec![]);
    let blocks = |t: &mut dyn Iterator<Item = &str>| {
        let h = t.next().unwrap().split_whitespace().nth(1).unwrap().parse::<usize>().unwrap();
        (0..h).map(|_| { let l = t.next().unwrap(); let mut w = l.split_whitespace(); (w.next().unwrap().to_string(), w.next().unwrap().parse::<usize>().unwrap()) }).collect::<Vec<_>>()
    };
    while let Some(k) = t.next() {
        let mut count = |t: &mut dyn Iterator<Item = &str>| t.next().unwrap().parse::<usize>().unwrap();
        match k {
            "VER" => { t.next(); }
            "OBJSENSE" => max = t.next() == Some("MAX"),
            "VAR" => vars = blocks(&mut t),
            "CON" => cons = blocks(&mut t),
            "INT" => { let n = count(&mut t); ints = (0..n).map(|_| t.next().unwrap().parse::<usize>().unwrap()).collect(); }
            "OBJACOORD" => { let n = count(&mut t); for _ in 0..n { let w: Vec<&str> = t.next().unwrap().split_whitespace().collect(); obj.push((w[0].parse::<usize>()?, w[1].parse::<f64>()?)); } }
            "OBJBCOORD" => obj0 = t.next().unwrap().parse()?,
            "ACOORD" => { let n = count(&mut t); for _ in 0..n { let w: Vec<&str> = t.next().unwrap().split_whitespace().collect(); a.push((w[0].parse::<usize>()?, w[1].parse::<usize>()?, w[2].parse::<f64>()?)); } }
            "BCOORD" => { let n = count(&mut t); for _ in 0..n { let w: Vec<&str> = t.next().unwrap().split_whitespace().collect(); b.push((w[0].parse::<usize>()?, w[1].parse::<f64>()?)); } }
            other => panic!("{other}"),
        }
    }
    let inf = f64::INFINITY;
    let is_int: std::collections::BTreeSet<usize> = ints.into_iter().collect();
    let mut x = vec![];
    let mut later = vec![];
    for (k, d) in &vars {
        let first = x.len();
        for e in 0..*d {
            let (mut lo, mut hi) = (-inf, inf);
            match k.as_str() { "L+" => lo = 0.0, "L-" => hi = 0.0, "L=" => { lo = 0.0; hi = 0.0 } "Q" if e == 0 => lo = 0.0, "QR" if e < 2 => lo = 0.0, _ => {} }
            let i = x.len();
            x.push(if is_int.contains(&i) { m.integer(("x", i), lo, hi)? } else { m.continuous(("x", i), lo, hi)? });
        }
        if k == "Q" || k == "QR" { later.push((k.clone(), (first..first + d).collect::<Vec<_>>())); }
    }
    for (n, (k, c)) in later.into_iter().enumerate() {
        if k == "Q" { m.add(("q", n), norm(c[1..].iter().map(|&i| x[i])).le(x[c[0]]))?; }
        else { let s: Quadratic = c[2..].iter().map(|&i| x[i].square()).sum(); m.add(("q", n), s.le(2.0 * x[c[0]] * x[c[1]]))?; }
    }
    let nrows: usize = cons.iter().map(|c| c.1).sum();
    let mut rows = vec![Affine::zero(); nrows];
    for (i, j, v) in a { rows[i].add_term(v, x[j]); }
    for (i, v) in b { rows[i] += v; }
    let mut r = 0;
    for (n, (k, d)) in cons.iter().enumerate() {
        let e = &rows[r..r + d];
        match k.as_str() {
            "L+" | "L-" | "L=" => for (i, e) in e.iter().enumerate() {
                if e.terms().is_empty() { continue; }
                let row = match k.as_str() { "L+" => e.ge(0.0), "L-" => e.le(0.0), _ => e.equals(0.0) };
                m.add(("r", r + i), row)?;
            },
            "Q" => { m.add(("c", n), norm(e[1..].to_vec()).le(e[0].clone()))?; }
            "QR" => {
                let mut h = vec![];
                for (i, e) in e[..2].iter().enumerate() {
                    let v = if e.terms().is_empty() { let c = e.offset(); m.continuous(("h", 2 * n + i), c, c)? } else { let v = m.continuous(("h", 2 * n + i), 0.0, inf)?; m.add(("hr", 2 * n + i), (e - v).equals(0.0))?; v };
                    h.push(v);
                }
                let mut s = Quadratic::zero();
                for (i, e) in e[2..].iter().enumerate() {
                    let t = e.terms();
                    if t.len() == 1 && t[0].1 == 1.0 && e.offset() == 0.0 { s += t[0].0.square(); } else { let v = m.continuous(("t", r + i), -inf, inf)?; m.add(("tr", r + i), (e - v).equals(0.0))?; s += v.square(); }
                }
                m.add(("c", n), s.le(2.0 * h[0] * h[1]))?;
            }
            _ => {}
        }
        r += d;
    }
    let mut o = Affine::constant(obj0);
    for (j, v) in obj { o.add_term(v, x[j]); }
    if max { m.maximize(o)? } else { m.minimize(o)? }
    let mut s = BranchAndBound::default();
    s.options_mut().time_limit = Some(std::time::Duration::from_secs_f64(limit));
    let t = std::time::Instant::now();
    let r = if std::env::var_os("LOG").is_some() { let mut log = Log::new(std::io::stderr()); let mut f = |e: &Event| log.record(e); let mut c = Control::default().with_progress(&mut f); s.solve_with(&m, &mut c)? } else { s.solve(&m)? };
    println!("{:?} {:?} bound {} nodes {} relax {} time {:.2} {:?}", r.termination(), r.objective(), r.bound(), r.statistics().nodes, r.statistics().relaxations, t.elapsed().as_secs_f64(), r.statistics().relaxation_counts);
    Ok(())
}
