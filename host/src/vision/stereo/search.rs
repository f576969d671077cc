//! The boxes that explain two pictures best: found one by one, improved, then improved together.

use super::gain::{Canvas, LEAST_HEIGHT, MOST_HEIGHT, overlap};
use super::pair::Pair;
use super::raised::RaisedBox;
use crate::geometry::Rect;
use crate::vision::image::{CellRect, Raster, rectangles};

/// Heights that candidates start with, metres.
const HEIGHTS: [f64; 9] = [0.06, 0.10, 0.14, 0.18, 0.23, 0.28, 0.34, 0.40, 0.48];
/// What a cell must cost as background, or how much the pictures must disagree, to propose a box.
const FOREIGN: f32 = 0.6;
/// Proposals have at least this many square metres.
const LEAST_PROPOSAL: f64 = 0.0006;
/// Two patches may be the sides of one box: at most this far apart, metres, sharing so much of their
/// extent.
const MOST_APART: f64 = 0.7;
const SHARED: f64 = 0.55;
/// Steps of the search: cells for edges, metres for the height.
const STEPS: [(f64, f64); 4] = [(4.0, 0.04), (2.0, 0.02), (1.0, 0.01), (0.5, 0.004)];
/// How many of these every candidate goes through.
const COARSE_STEPS: usize = 2;
/// Boxes that are looked for at most.
const MOST_BOXES: usize = 40;
/// Heights that are kept of each candidate, and how many are improved before the best is taken.
const KEPT_HEIGHTS: usize = 2;
const IMPROVED: usize = 5;
/// How often all boxes are improved together.
const ROUNDS: usize = 2;
/// One box is better than two if it explains this share of what they do.
const MERGE_SHARE: f32 = 0.93;

/// A box with what it saves.
#[derive(Clone, Copy)]
struct Scored {
    gain: f32,
    raised: RaisedBox,
}

/// Finds the boxes.
pub(crate) fn find(pair: &Pair) -> Vec<RaisedBox> {
    let search = Search { pair };
    let mut canvas = Canvas::with(pair, &[]);
    let mut candidates = search.candidates(&canvas);
    let mut found = Vec::new();
    while found.len() < MOST_BOXES {
        let Some(best) = search.best(&mut candidates, &canvas) else { break };
        canvas.explain(best.raised);
        found.push(best.raised);
    }
    for _ in 0..ROUNDS {
        search.merge(&mut found);
        search.improve_all(&mut found);
    }
    found
}

struct Search<'a> {
    pair: &'a Pair,
}

impl Search<'_> {
    /// Boxes worth a try: every proposal as top and as outline, at its best heights.
    fn candidates(&self, canvas: &Canvas) -> Vec<Scored> {
        let views = self.pair.views;
        let mut found = Vec::new();
        let mut consider = |reading: &dyn Fn(f64) -> RaisedBox| {
            let scored = |height: f64| {
                let raised = reading(height);
                Scored { gain: canvas.gain(raised), raised }
            };
            let mut tried: Vec<Scored> = HEIGHTS.into_iter().map(scored).collect();
            tried.sort_by(|a, b| b.gain.total_cmp(&a.gain));
            found.extend(tried.into_iter().take(KEPT_HEIGHTS).filter(|one| one.gain.is_finite()));
        };
        for (eye, patches) in self.coloured().iter().enumerate() {
            for &rect in patches {
                consider(&|height| RaisedBox::under(rect, views[eye], height));
                consider(&|height| RaisedBox::within(rect, [views[eye]; 2], height));
            }
        }
        for &rect in &self.disagreeing() {
            consider(&|height| RaisedBox::within(rect, views, height));
            for view in views {
                consider(&|height| RaisedBox::under(rect, view, height));
            }
        }
        self.led_on(found, canvas)
    }

    /// Where candidates lead in coarse steps; those that lead to the same place count once.
    fn led_on(&self, mut candidates: Vec<Scored>, canvas: &Canvas) -> Vec<Scored> {
        candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let mut tried: Vec<RaisedBox> = Vec::new();
        let mut led: Vec<Scored> = Vec::new();
        for candidate in candidates {
            if tried.iter().any(|other| alike(*other, candidate.raised)) {
                continue;
            }
            tried.push(candidate.raised);
            let improved = self.improved(candidate, canvas, &STEPS[..COARSE_STEPS]);
            if improved.gain > canvas.least_gain()
                && !led.iter().any(|other| alike(other.raised, improved.raised))
            {
                led.push(improved);
            }
        }
        led
    }

    /// Patches of each picture that do not look like background.
    fn coloured(&self) -> [Vec<Rect>; 2] {
        [0, 1].map(|eye| self.patches(&self.pair.background[eye]))
    }

    /// Patches on which the pictures disagree, alone and two by two: they are the two sides of a box
    /// whose top looks alike all over.
    fn disagreeing(&self) -> Vec<Rect> {
        let alone = self.patches(&self.pair.disagreement);
        let mut all = alone.clone();
        for (index, &a) in alone.iter().enumerate() {
            for &b in &alone[index + 1..] {
                if beside(a, b) {
                    all.push(around(a, b));
                }
            }
        }
        all
    }

    fn patches(&self, values: &Raster<f32>) -> Vec<Rect> {
        let frame = &self.pair.frame;
        let least = (LEAST_PROPOSAL * frame.scale * frame.scale).max(3.0);
        let metres = |cells: CellRect| {
            let corner =
                |column: usize, row: usize| frame.point(column as f64 - 0.5, row as f64 - 0.5);
            let (upper_left, lower_right) =
                (corner(cells.x0, cells.y0), corner(cells.x1, cells.y1));
            Rect::new(upper_left.x, lower_right.y, lower_right.x, upper_left.y)
        };
        rectangles(&values.map(|value| value > FOREIGN), least).into_iter().map(metres).collect()
    }

    /// The best candidate after the most promising ones are improved. Those that lead nowhere are
    /// dropped: what is explained later only lessens their gain.
    fn best(&self, candidates: &mut Vec<Scored>, canvas: &Canvas) -> Option<Scored> {
        for candidate in candidates.iter_mut() {
            candidate.gain = canvas.gain(candidate.raised);
        }
        candidates.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let mut tried: Vec<RaisedBox> = Vec::new();
        let mut best: Option<Scored> = None;
        let mut successes = 0;
        let mut next = 0;
        while successes < IMPROVED {
            let Some(&candidate) = candidates.get(next) else { break };
            if tried.iter().any(|other| alike(*other, candidate.raised)) {
                next += 1;
                continue;
            }
            tried.push(candidate.raised);
            let improved = self.improve(candidate, canvas);
            if improved.gain < canvas.least_gain() {
                candidates.retain(|other| !alike(other.raised, candidate.raised));
                continue;
            }
            successes += 1;
            next += 1;
            if best.is_none_or(|best| improved.gain > best.gain) {
                best = Some(improved);
            }
        }
        best
    }

    /// Moves edges and height in shrinking steps as long as the gain grows.
    fn improve(&self, start: Scored, canvas: &Canvas) -> Scored {
        self.improved(start, canvas, &STEPS)
    }

    fn improved(&self, start: Scored, canvas: &Canvas, steps: &[(f64, f64)]) -> Scored {
        let mut best = start;
        for &(cells, rise) in steps {
            let step = cells / self.pair.frame.scale;
            for _ in 0..12 {
                let before = best.gain;
                for change in 0..14 {
                    let raised = self.changed(best.raised, change, step, rise);
                    let gain = canvas.gain(raised);
                    if gain > best.gain {
                        best = Scored { gain, raised };
                    }
                }
                if best.gain <= before {
                    break;
                }
            }
        }
        best
    }

    /// One of the moves: 0 to 7 move an edge; 8 to 13 change the height, with the footprint, the
    /// first or the second picture's top kept.
    fn changed(&self, raised: RaisedBox, change: usize, step: f64, rise: f64) -> RaisedBox {
        let sign = if change.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut edges: [f64; 4] = raised.base.into();
        if let Some(edge) = edges.get_mut(change / 2) {
            *edge += sign * step;
            return RaisedBox { base: edges.into(), ..raised };
        }
        let height = (raised.height + sign * rise).clamp(LEAST_HEIGHT, MOST_HEIGHT);
        match self.pair.views.get(change / 2 - 4) {
            Some(&view) => raised.with_height(view, height),
            None => RaisedBox { height, ..raised },
        }
    }

    /// Improves every box given all others; what no longer pays is dropped.
    fn improve_all(&self, found: &mut Vec<RaisedBox>) {
        for index in (0..found.len()).rev() {
            let raised = found.remove(index);
            let canvas = Canvas::with(self.pair, found);
            let best = self.improve(Scored { gain: canvas.gain(raised), raised }, &canvas);
            if best.gain >= canvas.least_gain() {
                found.insert(index, best.raised);
            }
        }
    }

    /// Replaces two boxes by one around them where that explains nearly as much.
    fn merge(&self, found: &mut Vec<RaisedBox>) {
        let mut first = 0;
        while first < found.len() {
            let merged = (first + 1..found.len()).find_map(|second| {
                let (a, b) = (found[first], found[second]);
                self.merged(found, a, b).map(|whole| (second, whole))
            });
            match merged {
                Some((second, whole)) => {
                    found.remove(second);
                    found[first] = whole;
                }
                None => first += 1,
            }
        }
    }

    fn merged(&self, found: &[RaisedBox], a: RaisedBox, b: RaisedBox) -> Option<RaisedBox> {
        let union = around(a.base, b.base);
        if union.area() > 1.3 * (a.base.area() + b.base.area()) {
            return None;
        }
        let others: Vec<RaisedBox> =
            found.iter().copied().filter(|other| *other != a && *other != b).collect();
        let mut canvas = Canvas::with(self.pair, &others);
        let starts = [a.height, b.height].map(|height| RaisedBox { base: union, height });
        let best = starts
            .into_iter()
            .map(|raised| self.improve(Scored { gain: canvas.gain(raised), raised }, &canvas))
            .max_by(|a, b| a.gain.total_cmp(&b.gain))?;
        let mut apart = canvas.gain(a);
        canvas.explain(a);
        apart += canvas.gain(b);
        (best.gain > MERGE_SHARE * apart).then_some(best.raised)
    }
}

/// Whether two boxes are so near that they lead to the same place.
fn alike(a: RaisedBox, b: RaisedBox) -> bool {
    likeness(a.base, b.base) > 0.75 && (a.height - b.height).abs() < 0.04
}

fn around(a: Rect, b: Rect) -> Rect {
    Rect::new(a.x0.min(b.x0), a.y0.min(b.y0), a.x1.max(b.x1), a.y1.max(b.y1))
}

/// Intersection over union.
fn likeness(a: Rect, b: Rect) -> f64 {
    let shared = overlap(a, b);
    shared / (a.area() + b.area() - shared).max(1e-12)
}

/// Whether two patches face each other near by.
fn beside(a: Rect, b: Rect) -> bool {
    let shares = |low: f64, high: f64, shorter: f64| high - low > SHARED * shorter;
    let wide = shares(a.x0.max(b.x0), a.x1.min(b.x1), (a.x1 - a.x0).max(b.x1 - b.x0));
    let tall = shares(a.y0.max(b.y0), a.y1.min(b.y1), (a.y1 - a.y0).max(b.y1 - b.y0));
    let gap_x = a.x0.max(b.x0) - a.x1.min(b.x1);
    let gap_y = a.y0.max(b.y0) - a.y1.min(b.y1);
    (tall && gap_x < MOST_APART) || (wide && gap_y < MOST_APART)
}
