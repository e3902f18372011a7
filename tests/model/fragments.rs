//! The code in the tables and in the prose of the guide, which no doctest compiles: as it stands
//! there.

use carom::model::{PiecewiseAffine, sos1, sos2};
use carom::prelude::*;

#[test]
fn the_tables_of_the_modelling_guide_are_code() -> Result<(), Error> {
    let mut model = Model::new("tables");
    let hits = model.binary_family("hits", 6)?;
    let [a, b, z] = [model.binary("a")?, model.binary("b")?, model.binary("z")?];
    let n = model.integer("n", 0.0, 4.0)?;
    let of = |name: &str, model: &mut Model| model.continuous(name, 0.0, 9.0);
    let [x, y, w] = [of("x", &mut model)?, of("y", &mut model)?, of("w", &mut model)?];
    let [r, s] = [of("r", &mut model)?, of("s", &mut model)?];
    let expression = || x + 0.5 * y;
    let (e, e1, e2, e3) = (expression(), x - y, x + 1.0, 2.0 * y);
    let rows = [e.le(3.0), e.ge(3.0), e.equals(3.0), e.within(1.0, 3.0), e1.le(&e2)];
    let [r1, r2, r3, ..] = rows.clone();
    for (k, row) in rows.into_iter().enumerate() {
        model.add(("row", k), row)?;
    }
    let formulas = [
        a | !b,
        a & b,
        a.xor(b),
        a.implies(b | z),
        z.iff(a & b),
        a.iff(b),
        at_least(2, &hits) & at_most(4, &hits),
        at_least(3, &hits).implies(!a),
        at_most(1, &hits) | at_least(5, &hits),
        at_most(2, &hits),
    ];
    for (k, formula) in formulas.into_iter().enumerate() {
        model.add(("formula", k), formula)?;
    }
    model.add("if", z.on().implies(e.le(3.0)))?;
    model.add("if not", z.off().implies(e.le(3.0)))?;
    model.add("range", z.on().implies(e.within(1.0, 3.0)))?;
    model.add("all", z.on().implies_all([r1.clone(), r2.clone()]))?;
    model.add("length", z.on().implies(norm([e1.clone(), e2.clone()]).le(3.0)))?;
    model.add("both", (a & !b).implies(e.le(3.0)))?;
    model.add("exactly", z.on().reify(e.le(3.0), 0.01))?;
    model.add("equal", z.on().reify(e.equals(3.0), 0.01))?;
    let cones = [
        norm([e1.clone(), e2.clone()]).le(e3.clone()),
        ((x - 1.0).square() + (y - 2.0).square()).le(9.0),
        (x.square() + x * y + y.square()).le(&e),
        z.square().le(x * y),
        (x * y).ge(1.0),
        (x.square() + y.square()).le((r + s).square()),
        (e1.square() + e2.square()).le(&e3),
        x.square().le(&e2 * &e3),
    ];
    for (k, cone) in cones.into_iter().enumerate() {
        model.add(("cone", k), cone)?;
    }
    let r = 2.0;
    model.add("outside", either(x.ge(r)).or(x.le(-r)).or(y.ge(r)).or(y.le(-r)))?;
    model.add("either", either([r1, r2]).or(r3))?;
    let f = PiecewiseAffine::new([(0.0, 0.0), (5.0, 1.0), (14.0, 0.0)])?;
    model.product("ze", z, e.clone())?;
    model.product("ne", n, e.clone())?;
    model.absolute("absolute", e.clone())?;
    model.positive_part("positive", e.clone())?;
    model.maximum("largest", [e1.clone(), e2.clone(), e3])?;
    model.piecewise("curve", e, &f)?;
    model.norm("norm", [x, y])?;
    model.norm("long", [e1, e2])?;
    model.semicontinuous("semicontinuous", 2.0, 5.0)?;
    model.semiinteger("semiinteger", 3.0, 6.0)?;
    model.add("one", sos1([(x, 1.0), (y, 2.0)]))?;
    model.add("two", sos2([(x, 1.0), (y, 2.0), (w, 3.0)]))?;
    Ok(())
}

#[test]
fn the_table_of_the_guide_to_systems_is_code() -> Result<(), Error> {
    let mut car = HybridSystem::new(0.5);
    let x = car.state("x", -9.0, 9.0)?;
    let y = car.state("y", -9.0, 9.0)?;
    let v = car.state("v", -2.5, 2.5)?;
    let u = car.input("u", -1.0, 1.0)?;
    let [vx, vy] = [car.input("vx", -1.0, 1.0)?, car.input("vy", -1.0, 1.0)?];
    let price = car.series("price", vec![1.0, 2.0])?;
    car.limit("speed", norm([vx, vy]).le(3.0))?;
    car.limit("slow", v.le(1.0))?;
    car.invariant((x + y).le(3.0))?;
    let impact = car.output("impact")?;
    car.mode("coast")?
        .rates([x.is(v), v.is(0.6 * u)])?
        .guard(v.ge(0.4))?
        .guard(x.predicted().le(0.0))?
        .invariant(v.le(6.0))?
        .guard(norm([vx, vy]).le(2.0))?
        .output(impact, -v.predicted())?;
    car.mode("glide")?.next([x.is(x + 0.1 * v)])?;
    car.event("bounce")?.next([x.is(v)])?.reset([v.is(-0.5 * v.predicted())])?;
    car.expect("mode", false, true)?;
    let mut program = car.program(6)?;
    let cost = program.sum(price * u)?;
    program.minimize(cost)?;
    program.goal(norm([x - 4.0, y - 1.0]).le(0.5))?;
    let mut room = HybridSystem::new(0.5);
    let t = room.state("t", 0.0, 9.0)?;
    let [off, on] = room.modes("heater", ["off", "on"])?;
    room.stay(off)?.rates([t.is(-1.0)])?;
    room.stay(on)?.rates([t.is(1.0)])?;
    room.switch(off, on)?;
    room.dwell(on, 3, 9)?;
    program.join("second", &room)?;
    let mut cart = HybridSystem::new(0.5);
    let gap = cart.state("gap", 0.0, 9.0)?;
    let force = cart.input("force", 0.0, 9.0)?;
    cart.rates([gap.is(force - 1.0)])?;
    cart.complementarity("wall", force, gap)?;
    cart.mode_of("valve", "open")?;
    cart.event_of("hatch", "hit")?;
    cart.program(2)?;
    Ok(())
}
