//! The weight of risk, and why more of it never leads through greater risk.
//!
//! A way's cost is its length plus the weight times the integral of the risk along it. With more weight
//! the *integral* cannot grow, but the *greatest* risk could: a short passage of high risk replaces a long
//! one of some risk. So the ways for a ladder of weights are found one after the other from 0 upwards,
//! each with the greatest risk of the one before as its ceiling; a weight between two rungs takes the
//! cheaper of their two ways. As the way of the upper rung has less integral and no greater risk, the
//! greatest risk falls or stays from any weight to any larger one.
//!
//! Where the way for a rung has no risk beyond that of its ends, which no way avoids, the rungs below it
//! need not be looked at: no ceiling of theirs would change it.

use crate::geometry::Point;

/// The rungs above 0.
pub(super) const RUNGS: [f64; 13] =
    [0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 300.0, 1000.0];

/// A way with what it is judged by.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FuzzyWay {
    pub(super) points: Vec<Point>,
    /// Metres.
    pub(super) length: f64,
    /// The integral of the risk, metres.
    pub(super) integral: f64,
    /// The greatest risk.
    pub(super) greatest: f64,
}

impl FuzzyWay {
    pub(super) fn cost(&self, weight: f64) -> f64 {
        self.length + weight * self.integral
    }
}

/// The way for `weight`; `find` looks for the least cost at a weight below a ceiling of risk, and
/// `unavoidable` is a risk that every way has somewhere.
///
/// # Errors
/// That of the first way looked for.
pub(super) fn for_weight<E>(
    weight: f64,
    unavoidable: f64,
    find: &mut impl FnMut(f64, f64) -> Result<FuzzyWay, E>,
) -> Result<FuzzyWay, E> {
    let upper = RUNGS.partition_point(|&rung| rung < weight);
    let last = RUNGS.len() - 1;
    if upper > last || RUNGS[upper] == weight {
        return at_rung(upper.min(last), unavoidable, find);
    }
    let low = at_rung(upper - 1, unavoidable, find)?;
    if low.integral == 0.0 {
        return Ok(low);
    }
    let high = at_rung(upper, unavoidable, find)?;
    let is_low = low.integral >= high.integral && low.cost(weight) < high.cost(weight);
    Ok(if is_low { low } else { high })
}

/// The way of a rung, which keeps below the greatest risk of the rung before.
fn at_rung<E>(
    rung: usize,
    unavoidable: f64,
    find: &mut impl FnMut(f64, f64) -> Result<FuzzyWay, E>,
) -> Result<FuzzyWay, E> {
    let free = find(RUNGS[rung], f64::INFINITY)?;
    if rung == 0 || free.greatest <= unavoidable {
        return Ok(free);
    }
    let before = at_rung(rung - 1, unavoidable, find)?;
    if free.greatest <= before.greatest {
        return Ok(free);
    }
    // The way of the rung before keeps below its own risk, so there is always one.
    let bounded =
        find(RUNGS[rung], before.greatest).ok().filter(|way| way.greatest <= before.greatest);
    let is_better = |way: &FuzzyWay| way.cost(RUNGS[rung]) < before.cost(RUNGS[rung]);
    Ok(bounded.filter(is_better).unwrap_or(before))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn way((length, integral, greatest): (f64, f64, f64)) -> FuzzyWay {
        FuzzyWay { points: vec![], length, integral, greatest }
    }

    /// The cheapest of some ways that keep below a ceiling.
    fn choice(ways: &[FuzzyWay], weight: f64) -> Option<FuzzyWay> {
        let mut find = |weight: f64, ceiling: f64| {
            let allowed = ways.iter().filter(|way| way.greatest <= ceiling);
            let cheaper = |a: &&FuzzyWay, b: &&FuzzyWay| a.cost(weight).total_cmp(&b.cost(weight));
            allowed.min_by(cheaper).cloned().ok_or(())
        };
        for_weight(weight, 0.0, &mut find).ok()
    }

    #[test]
    fn a_short_passage_of_high_risk_never_replaces_a_long_one_of_some() {
        // At weight 5 the second costs 2.2 m and the first 2.5 m, but it is riskier at its worst.
        let ways = [(1.0, 0.3, 0.4), (1.8, 0.08, 0.9)].map(way);
        assert!(ways[1].cost(5.0) < ways[0].cost(5.0));
        assert_eq!(choice(&ways, 5.0).unwrap().greatest, 0.4);
        assert_eq!(choice(&ways, 0.0).unwrap().greatest, 0.4);
    }

    proptest! {
        #[test]
        fn more_weight_never_means_greater_risk(
            ways in proptest::collection::vec((1.0..3.0_f64, 0.0..0.5_f64, 0.0..1.0_f64), 1..8),
            [a, b] in proptest::array::uniform2(-2.0..3.0_f64),
        ) {
            let ways: Vec<FuzzyWay> = ways.into_iter().map(way).collect();
            let (less, more) = (10_f64.powf(a.min(b)), 10_f64.powf(a.max(b)));
            let (less, more) = (choice(&ways, less).unwrap(), choice(&ways, more).unwrap());
            prop_assert!(more.greatest <= less.greatest, "{less:?} {more:?}");
            prop_assert!(more.integral <= less.integral, "{less:?} {more:?}");
        }
    }
}
