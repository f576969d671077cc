//! The metric plan view: the floor seen straight from above, the same number of cells to every metre.
//!
//! Cells hold linear light. The view reaches a margin beyond the arena, because tall boxes lean out of
//! it. Column 0 lies at x = −margin, row 0 at y = height + margin; metres in the arena frame.

use super::frame::PlanFrame;
use super::sampling::Lattice;
use crate::geometry::Point;
use crate::vision::camera::PlanMap;
use crate::vision::image::{Photo, Place, Raster};

/// The most places along each side of a cell.
const MOST_PLACES: usize = 4;

/// Draws the plan view of a photo, in linear light.
///
/// Where the photo is finer than the view a cell is the mean of several places, at most 4 × 4.
pub fn plan_view(photo: &Photo, map: &PlanMap, frame: &PlanFrame) -> Raster<[f32; 3]> {
    view_of(photo, map, frame, |light| light)
}

/// The plan view of what `take` makes of every cell's light.
pub(crate) fn view_of<T: Copy>(
    photo: &Photo,
    map: &PlanMap,
    frame: &PlanFrame,
    take: impl Fn([f32; 3]) -> T,
) -> Raster<T> {
    let (width, height) = frame.size();
    let places = places(map, frame);
    let fine = frame.finer(places);
    let mut lattice = Lattice::new(photo, map, fine, width * places);
    let mut sums = vec![[0f32; 3]; width];
    let share = 1.0 / (places * places) as f32;
    let mut cells = Vec::with_capacity(width * height);
    for row in 0..height {
        sums.fill([0.0; 3]);
        for line in row * places..(row + 1) * places {
            let line = lattice.line(line);
            // The mean of many places is as smooth without interpolation at each of them.
            match places {
                1 => add_line::<1>(line, &mut sums, |at| photo.light_at(at)),
                2 => add_line::<2>(line, &mut sums, |at| photo.light_at(at)),
                3 => add_line::<3>(line, &mut sums, |at| photo.light_near(at)),
                _ => add_line::<4>(line, &mut sums, |at| photo.light_near(at)),
            }
        }
        cells.extend(sums.iter().map(|sum| take(sum.map(|value| value * share))));
    }
    Raster::from_cells(width, cells)
}

/// Places along each side of a cell whose light is averaged.
fn places(map: &PlanMap, frame: &PlanFrame) -> usize {
    let middle = Point::new(frame.arena.width / 2.0, frame.arena.height / 2.0);
    (map.scale_at(middle) / frame.scale).round().clamp(1.0, MOST_PLACES as f64) as usize
}

/// Adds the light along a line of places, `EACH` of them to every cell.
fn add_line<const EACH: usize>(
    line: &[Place],
    sums: &mut [[f32; 3]],
    light: impl Fn(Place) -> [f32; 3],
) {
    for (sum, places) in sums.iter_mut().zip(line.as_chunks::<EACH>().0) {
        places.iter().for_each(|&place| add(sum, light(place)));
    }
}

#[inline]
fn add(sum: &mut [f32; 3], light: [f32; 3]) {
    sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
}

/// The light of one cell of the plan view by its column and row.
pub(crate) fn cell_light(
    photo: &Photo,
    map: &PlanMap,
    frame: &PlanFrame,
) -> impl Fn(usize, usize) -> [f32; 3] {
    let places = places(map, frame);
    let fine = frame.finer(places);
    let share = 1.0 / (places * places) as f32;
    move |column, row| {
        let mut sum = [0f32; 3];
        for line in row * places..(row + 1) * places {
            for within in column * places..(column + 1) * places {
                let point = fine.point(within as f64, line as f64);
                add(&mut sum, photo.light(map.to_photo(point)));
            }
        }
        sum.map(|value| value * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Arena;

    #[test]
    fn a_cell_shows_what_lies_at_its_point() {
        let pixels = (0..100 * 100).map(|i| if i % 100 < 50 { [255; 3] } else { [0; 3] });
        let photo = Photo::from_rgb(100, 100, pixels.collect()).unwrap();
        let arena = Arena { width: 0.8, height: 0.8 };
        let corners = [[9.5, 89.5], [89.5, 89.5], [89.5, 9.5], [9.5, 9.5]];
        let map = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
        let frame = PlanFrame::new(arena, 100.0, 0.05);
        let view = plan_view(&photo, &map, &frame);
        assert_eq!((view.width(), view.height()), (90, 90));
        assert!(view.get(44, 40).unwrap()[0] > 0.99 && view.get(45, 40).unwrap()[0] < 0.01);
        let (column, row) = frame.cell(frame.point(12.0, 34.0));
        assert!((column - 12.0).abs() < 1e-9 && (row - 34.0).abs() < 1e-9);
    }
}
