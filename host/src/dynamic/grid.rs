//! The coarse grid over time: what each cell's membership of the free floor is in each layer of time.
//!
//! A cell is a place where the robot may turn or wait. Its membership is 1 where nothing is, 0 where it is
//! forbidden to be, and between them 1 - risk. Layers are [`STEP`] apart. A cell's layers are made when they are
//! first asked for: a search sees few of the cells. Metres, seconds.

use super::future::HORIZON;
use super::{Demand, Future};
use crate::geometry::{Arena, Point};

/// The time from one layer to the next, s.
const STEP: f64 = 0.2;

/// Cells are made so large that there are no more of them than this, and no smaller than the smallest, m.
const CELLS: f64 = 400.0;
const SMALLEST: f64 = 0.05;

/// A place of the grid: first the cells, row by row from the lower left, then the places that were added.
pub type CellIndex = usize;

/// The grid.
#[derive(Clone, Debug)]
pub struct TimeGrid<'a> {
    futures: &'a [Future],
    demand: Demand,
    columns: usize,
    rows: usize,
    side: f64,
    places: Vec<Point>,
    layers: Vec<Option<Vec<f32>>>,
}

impl<'a> TimeGrid<'a> {
    /// The grid over `arena`, and `places` of its own beside the middles of its cells.
    pub fn new(arena: Arena, futures: &'a [Future], demand: Demand, places: &[Point]) -> Self {
        let side = (arena.width * arena.height / CELLS).sqrt().max(SMALLEST);
        let count = |length: f64| (length / side).floor().max(1.0) as usize;
        let (columns, rows) = (count(arena.width), count(arena.height));
        let middle =
            |index: usize, count: usize, length: f64| (index as f64 + 0.5) * length / count as f64;
        let mut all: Vec<Point> = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .map(|(column, row)| {
                Point::new(middle(column, columns, arena.width), middle(row, rows, arena.height))
            })
            .collect();
        all.extend(places);
        let layers = vec![None; all.len()];
        Self { futures, demand, columns, rows, side, places: all, layers }
    }

    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }

    /// The side of a cell, m.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// How many places there are.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Where a place is.
    pub fn place(&self, index: CellIndex) -> Point {
        self.places[index]
    }

    /// The membership of a place at a time, 0 to 1.
    pub fn membership(&mut self, index: CellIndex, time: f64) -> f64 {
        let layers = self.layers(index);
        let layer = ((time / STEP).round().max(0.0) as usize).min(layers.len() - 1);
        f64::from(layers[layer])
    }

    /// Until when one may stay at a place from `time` on; `time` itself if one may not be there.
    pub fn free_until(&mut self, index: CellIndex, time: f64) -> f64 {
        let layers = self.layers(index);
        let first = (time / STEP).round().max(0.0) as usize;
        let blocked = layers.iter().skip(first).position(|membership| *membership <= 0.0);
        blocked.map_or(f64::INFINITY, |layers| time.max(STEP * (first + layers) as f64 - STEP))
    }

    fn layers(&mut self, index: CellIndex) -> &[f32] {
        let (futures, demand, place) = (self.futures, self.demand, self.places[index]);
        self.layers[index].get_or_insert_with(|| {
            let count = (HORIZON / STEP) as u32;
            let membership = |layer: u32| {
                let band = demand.at(futures, place, STEP * f64::from(layer));
                if band.gap < 0.0 { 0.0 } else { 1.0 - band.risk as f32 }
            };
            (0..=count).map(membership).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Circle;

    /// A disc of 0.1 m goes along y = 0.5 m from x = 0 at 0.2 m/s, 0.02 m unsure; the robot keeps 0.08 m.
    #[test]
    fn memberships_fall_and_rise_as_a_disc_passes() {
        let disc = Circle { centre: Point::new(0.0, 0.5), radius: 0.1 };
        let moves = (0..=150).map(|layer| ([0.02 * f64::from(layer), 0.0], 0.02));
        let futures = [Future::new(disc.into(), moves)];
        let demand = Demand { keep: 0.08, sure: 1.0 };
        let place = Point::new(1.0, 0.5);
        let mut grid = TimeGrid::new(Arena { width: 2.0, height: 1.0 }, &futures, demand, &[place]);
        let index = grid.len() - 1;
        assert_eq!((grid.size(), grid.place(index)), ((28, 14), place));
        // It is 0.2 m away at 4 s and again at 6 s.
        let at = |grid: &mut TimeGrid, time| grid.membership(index, time);
        assert_eq!([3.6, 5.0, 6.4].map(|time| at(&mut grid, time)), [1.0, 0.0, 1.0]);
        assert!((grid.free_until(index, 0.0) - 4.0).abs() < 1.5 * STEP);
        assert_eq!(grid.free_until(index, 6.4), f64::INFINITY);
    }
}
