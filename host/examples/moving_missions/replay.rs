//! Tracks of things that crossed a floor, and where each was at a time. Metres, seconds.

use std::collections::BTreeMap;
use std::error::Error;
use wmr::geometry::{Arena, Point};

/// What was seen of one thing: times and places.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    points: Vec<(f64, Point)>,
}

impl Track {
    /// When it was seen first and last.
    pub(crate) fn span(&self) -> (f64, f64) {
        (self.points[0].0, self.points[self.points.len() - 1].0)
    }

    /// Where it was. Before it was first seen it came straight, and after it was last seen it went straight on:
    /// nothing appears on the floor or vanishes from it.
    pub(crate) fn at(&self, time: f64) -> Point {
        let next = self.points.partition_point(|(at, _)| *at < time);
        let next = next.clamp(1, self.points.len() - 1);
        let [(before, a), (after, b)] = [self.points[next - 1], self.points[next]];
        let share = (time - before) / (after - before);
        Point::new(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y))
    }
}

/// All tracks, and the floor that holds them.
#[derive(Clone, Debug)]
pub(crate) struct Replay {
    pub(crate) tracks: Vec<Track>,
    pub(crate) arena: Arena,
}

impl Replay {
    /// Reads the columns `time_s,id,x_m,y_m`; lengths are multiplied by `scale`.
    pub(crate) fn read(text: &str, scale: f64) -> Result<Self, Box<dyn Error>> {
        let mut points: BTreeMap<String, Vec<(f64, Point)>> = BTreeMap::new();
        for line in text.lines().skip(1).filter(|line| !line.trim().is_empty()) {
            let fields: Vec<&str> = line.split(',').collect();
            let [time, id, x, y] = fields[..] else {
                return Err(format!("{line:?} has not four columns").into());
            };
            let number = |text: &str| text.trim().parse::<f64>();
            let place = Point::new(scale * number(x)?, scale * number(y)?);
            points.entry(id.into()).or_default().push((number(time)?, place));
        }
        let all = || points.values().flatten().map(|(_, place)| *place);
        let low = all().fold([f64::INFINITY; 2], |[x, y], at| [x.min(at.x), y.min(at.y)]);
        let high = all().fold([f64::NEG_INFINITY; 2], |[x, y], at| [x.max(at.x), y.max(at.y)]);
        let arena = Arena { width: high[0] - low[0], height: high[1] - low[1] };
        let moved = |(time, at): &(f64, Point)| (*time, Point::new(at.x - low[0], at.y - low[1]));
        let tracks = points.values().filter(|points| points.len() > 1);
        let tracks = tracks.map(|points| Track { points: points.iter().map(moved).collect() });
        Ok(Self { tracks: tracks.collect(), arena })
    }
}
