//! Where the cells of a plan view lie in the photo, line by line.
//!
//! The map from floor to photo is evaluated at every eighth cell and taken as linear in between: over so
//! few centimetres of floor homography and lens bend by hundredths of a pixel. Places in the photo are
//! fixed-point pixels with [`FRACTION`] bits behind the point, moved to the photo's rim where they lie beyond.

use super::frame::PlanFrame;
use crate::vision::camera::PlanMap;
use crate::vision::image::{FRACTION, Photo, Place};

/// Cells between exact places.
const STEP: usize = 8;
/// Points at the horizon of the floor would lie farther off than this, pixels: places fit 32 bits.
const FAR: f64 = 1e6;

/// The places of the centres of a plan view's cells.
pub(crate) struct Lattice<'a> {
    map: &'a PlanMap,
    frame: PlanFrame,
    columns: usize,
    /// The greatest column and row, fixed-point.
    most: [i32; 2],
    /// The exact places above and below the present line, and the number of the line above.
    exact: [Vec<[f64; 2]>; 2],
    above: Option<usize>,
    line: Vec<Place>,
}

impl<'a> Lattice<'a> {
    /// The lattice of the first `columns` cells of every line of a frame.
    pub(crate) fn new(photo: &Photo, map: &'a PlanMap, frame: PlanFrame, columns: usize) -> Self {
        let most = [photo.width(), photo.height()]
            .map(|length| (((length as i32).min(FAR as i32) - 1) << FRACTION) - 1);
        let line = Vec::with_capacity(columns + STEP);
        Self { map, frame, columns, most, exact: Default::default(), above: None, line }
    }

    /// The places of a line of cells.
    pub(crate) fn line(&mut self, number: usize) -> &[Place] {
        let above = number / STEP * STEP;
        if self.above != Some(above) {
            let next = self.above.is_some_and(|last| last + STEP == above);
            let first = if next { std::mem::take(&mut self.exact[1]) } else { self.exact(above) };
            self.exact = [first, self.exact(above + STEP)];
            self.above = Some(above);
        }
        let share = (number - above) as f64 / STEP as f64;
        let mix = |index: usize| {
            let ([x0, y0], [x1, y1]) = (self.exact[0][index], self.exact[1][index]);
            let fixed = |value: f64| (value * f64::from(1 << FRACTION)) as i32;
            [fixed(x0 + share * (x1 - x0)), fixed(y0 + share * (y1 - y0))]
        };
        let [right, bottom] = self.most;
        let inside = |[x, y]: [i32; 2]| (0..=right).contains(&x) && (0..=bottom).contains(&y);
        self.line.clear();
        let mut end = mix(0);
        for index in 1..self.exact[0].len() {
            let [x, y] = std::mem::replace(&mut end, mix(index));
            let (dx, dy) = ((end[0] - x) / STEP as i32, (end[1] - y) / STEP as i32);
            let places: [[i32; 2]; STEP] =
                std::array::from_fn(|i| [x + i as i32 * dx, y + i as i32 * dy]);
            if inside([x, y]) && inside(end) {
                self.line.extend(places.map(|[x, y]| [x as u32, y as u32]));
            } else {
                let on_rim = |[x, y]: [i32; 2]| [x.clamp(0, right), y.clamp(0, bottom)];
                self.line.extend(places.map(on_rim).map(|[x, y]| [x as u32, y as u32]));
            }
        }
        &self.line[..self.columns]
    }

    fn exact(&self, line: usize) -> Vec<[f64; 2]> {
        (0..=self.columns.div_ceil(STEP))
            .map(|index| {
                let point = self.frame.point((index * STEP) as f64, line as f64);
                self.map.to_photo(point).map(|value| value.clamp(-FAR, FAR))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Arena;

    /// Linear steps of 8 cells leave the map by less than this, pixels.
    const BEND: f64 = 0.02;

    #[test]
    fn places_are_those_of_the_map_or_on_the_rim() {
        let photo = Photo::from_rgb(400, 300, vec![[0; 3]; 400 * 300]).unwrap();
        let arena = Arena { width: 1.3, height: 1.1 };
        let corners = [[-15.0, 280.0], [380.0, 260.0], [350.0, 30.0], [60.0, 20.0]];
        let map = PlanMap::from_corners(&photo, arena, corners, -0.05).unwrap();
        let frame = PlanFrame::new(arena, 300.0, 0.05);
        let (width, height) = frame.size();
        let mut lattice = Lattice::new(&photo, &map, frame, width);
        // Out of order too: a line does not depend on those asked for before.
        for row in (0..height).step_by(7).chain([3, 200, 11]) {
            for (column, place) in lattice.line(row).iter().enumerate() {
                let [x, y] = map.to_photo(frame.point(column as f64, row as f64));
                let expected = [x.clamp(0.0, 399.0), y.clamp(0.0, 299.0)];
                for (seen, expected) in place.iter().zip(expected) {
                    let seen = f64::from(*seen) / f64::from(1 << FRACTION);
                    assert!((seen - expected).abs() < BEND, "{seen} {expected}");
                }
            }
        }
    }
}
