use super::*;
use crate::extended::tests::Random;

/// A number with 24 binary places between -64 and 64: sums and products of two are exact.
fn short(random: &mut Random) -> f64 {
    64.0 * f64::from(random.signed())
}

fn holds(x: Enclosure, truth: f64) -> bool {
    x.lower <= truth && truth <= x.upper
}

#[test]
fn operations_enclose_what_is_exact_and_are_a_few_roundings_wide() {
    let mut random = Random(1);
    for _ in 0..10_000 {
        let [a, b] = [(); 2].map(|()| short(&mut random));
        let [x, y] = [a, b].map(Enclosure::from);
        for (found, exact) in [(x + y, a + b), (x - y, a - b), (x * y, a * b), (x * x, a * a), (-x, -a)] {
            assert!(found.lower <= exact && exact <= found.upper, "{a} {b}: {found:?}");
            assert!(found.upper - found.lower <= exact.abs() * 1e-15 + 1e-300, "{a} {b}: {found:?}");
        }
        if b != 0.0 {
            let quotient = x / y;
            assert!(holds(quotient * y, a), "{a} / {b}");
        }
        let root = x.abs().sqrt();
        assert!(holds(root * root, a.abs()) && (root * root).upper <= a.abs() * (1.0 + 1e-14) + 1e-300, "{a}");
    }
}

#[test]
fn wide_enclosures_hold_every_result_of_what_they_hold() {
    let mut random = Random(2);
    let between = |x: Enclosure, share: f64| x.lower + share * (x.upper - x.lower);
    for _ in 0..10_000 {
        let [a, b, c, d] = [(); 4].map(|()| f64::from(random.between(-2.0, 2.0)));
        let x = Enclosure { lower: a.min(b), upper: a.max(b) };
        let y = Enclosure { lower: c.min(d), upper: c.max(d) };
        let [p, q] = [between(x, f64::from(random.between(0.0, 1.0))), between(y, f64::from(random.between(0.0, 1.0)))];
        let two = [
            (x + y, p + q),
            (x - y, p - q),
            (x * y, p * q),
            (x.greater(y), p.max(q)),
            (x.lesser(y), p.min(q)),
            (x.hypot(y), p.hypot(q)),
            (x.abs(), p.abs()),
            (x.square(), p * p),
            (x.exp(), p.exp()),
            (x.abs().sqrt(), p.abs().sqrt()),
            (x.abs().ln_1p(), p.abs().ln_1p()),
        ];
        for (operation, (found, truth)) in two.into_iter().enumerate() {
            assert!(holds(found, truth), "{operation}: {truth} outside {found:?}");
        }
        let quotient = x / y;
        assert!(if y.lower * y.upper > 0.0 { holds(quotient, p / q) } else { quotient.lower.is_nan() }, "{quotient:?}");
    }
}

#[test]
fn what_is_undefined_stays_undefined_and_nothing_holds_of_it() {
    let none = Enclosure::from(1.0) / (Enclosure::from(1.0) - 1.0);
    let all = [none + 1.0, none * 0.0, none.greater(0.0.into()), none.lesser(0.0.into()), none.sqrt(), none.abs()];
    for x in all.into_iter().chain([Enclosure::from(-1.0).sqrt(), Enclosure::from(f64::INFINITY).exp()]) {
        assert!(x.lower.is_nan() || x.upper.is_nan(), "{x:?}");
        assert!(!(x.upper() < f64::INFINITY && x.lower() > f64::NEG_INFINITY), "{x:?}");
    }
}

/// e and ln 2 to more digits than double precision has: the two numbers on either side.
#[test]
fn exponential_and_logarithm_enclose_the_known_constants() {
    let e = Enclosure::from(1.0).exp();
    assert!(holds(e, core::f64::consts::E) && e.upper - e.lower < 1e-12, "{e:?}");
    let two = Enclosure::from(1.0).ln_1p();
    assert!(holds(two, core::f64::consts::LN_2) && two.upper - two.lower < 1e-11, "{two:?}");
    let mut random = Random(3);
    for _ in 0..2_000 {
        let x = f64::from(random.between(-30.0, 30.0));
        let sum = (Enclosure::from(x).exp() * Enclosure::from(-x).exp()).lower;
        assert!(sum <= 1.0 && sum > 1.0 - 1e-9, "{x}: {sum}");
        assert!(holds(Enclosure::from(x).exp(), x.exp()));
        let y = f64::from(random.between(-0.999, 1e3));
        let logarithm = Enclosure::from(y).ln_1p();
        assert!(logarithm.upper - logarithm.lower < 1e-8 * y.ln_1p().abs() + 1e-12, "{y}: {logarithm:?}");
    }
}

#[test]
fn the_greatest_root_of_a_cubic_lies_between_its_ends() {
    let mut random = Random(4);
    for trial in 0..2_000 {
        // From three roots whose sum is zero: the greatest is known.
        let [a, b] = [(); 2].map(|()| short(&mut random));
        let b = if trial % 10 == 0 { a } else { b };
        let c = -a - b;
        let [p, q] = [-(a * b + b * c + c * a), a * b * c].map(Enclosure::from);
        let [pp, qq] = [[a * b, b * c, c * a], [a * b * c; 3]];
        let slack = |terms: [f64; 3]| terms.iter().map(|t| t.abs()).sum::<f64>() * 1e-15;
        let p = p + Enclosure { lower: -slack(pp), upper: slack(pp) };
        let q = q + Enclosure { lower: -slack(qq), upper: slack(qq) };
        let root = Enclosure::max_cubic_root(p, q);
        let max = a.max(b).max(c);
        assert!(holds(root, max), "{a} {b} {c}: {root:?}");
        let apart = if trial % 10 == 0 { 1e-2 } else { 1e-5 };
        assert!(root.upper - root.lower <= apart * max.abs() + 1e-100 || (a - b).abs() < 1e-3 * a.abs(), "{root:?}");
    }
}
