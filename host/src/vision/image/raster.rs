//! A grid of cells, row by row from the top left: the shape of every picture inside vision.
//!
//! Columns run to the right and rows down, as in the photo; the centre of the top-left cell is (0, 0).

use super::components::runs;

/// A rectangular grid of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster<T> {
    width: usize,
    height: usize,
    cells: Vec<T>,
}

impl<T: Copy> Raster<T> {
    /// A grid of `width` × `height` cells, all `value`.
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self { width, height, cells: vec![value; width * height] }
    }

    /// A grid whose cell at column x and row y is `value(x, y)`.
    ///
    /// ```
    /// use wmr::vision::Raster;
    /// let sums = Raster::from_fn(3, 2, |x, y| x + y);
    /// assert_eq!(sums.row(1), [1, 2, 3]);
    /// ```
    pub fn from_fn(width: usize, height: usize, mut value: impl FnMut(usize, usize) -> T) -> Self {
        let mut cells = Vec::with_capacity(width * height);
        for y in 0..height {
            cells.extend((0..width).map(|x| value(x, y)));
        }
        Self { width, height, cells }
    }

    /// A grid of rows of `width` cells each; what is left of a last row is dropped.
    pub(crate) fn from_cells(width: usize, mut cells: Vec<T>) -> Self {
        let height = cells.len().checked_div(width).unwrap_or(0);
        cells.truncate(width * height);
        Self { width, height, cells }
    }

    /// The number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The cells, row by row from the top left.
    pub fn cells(&self) -> &[T] {
        &self.cells
    }

    /// The cells, row by row from the top left, to be changed.
    pub fn cells_mut(&mut self) -> &mut [T] {
        &mut self.cells
    }

    /// Row `y` from the left; empty outside of the grid.
    pub fn row(&self, y: usize) -> &[T] {
        self.cells.get(y * self.width..(y + 1) * self.width).unwrap_or(&[])
    }

    /// The cell at column `x`, row `y`; `None` outside of the grid.
    pub fn get(&self, x: i64, y: i64) -> Option<T> {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        if x < self.width { self.cells.get(y * self.width + x).copied() } else { None }
    }

    /// Changes the cell at column `x`, row `y`; nothing outside of the grid.
    pub fn set(&mut self, x: i64, y: i64, value: T) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x < self.width
            && let Some(cell) = self.cells.get_mut(y * self.width + x)
        {
            *cell = value;
        }
    }

    /// The grid of `change(cell)`.
    pub fn map<U: Copy>(&self, change: impl FnMut(T) -> U) -> Raster<U> {
        Raster {
            width: self.width,
            height: self.height,
            cells: self.cells.iter().copied().map(change).collect(),
        }
    }
}

impl Raster<bool> {
    /// The connected regions of cells that are `wanted`, neighbours by their four sides: the number of
    /// the region of every cell (0 for a cell that is not wanted) and how many regions there are.
    ///
    /// ```
    /// use wmr::vision::Raster;
    /// let mask = Raster::from_fn(3, 1, |x, _| x != 1);
    /// let (regions, count) = mask.regions(true);
    /// assert_eq!((regions.cells(), count), (&[1, 0, 2][..], 2));
    /// ```
    pub fn regions(&self, wanted: bool) -> (Raster<u32>, usize) {
        let mut regions = Raster::filled(self.width, self.height, 0u32);
        let (runs, count) = runs(self, wanted);
        for run in runs {
            let row = run.row * self.width;
            regions.cells[row + run.start..row + run.end].fill(run.region);
        }
        (regions, count)
    }

    /// The marked cells with all that are reached from them by steps to a side for which `joins`, given the
    /// indices of the cell before and after the step.
    ///
    /// ```
    /// use wmr::vision::Raster;
    /// let start = Raster::from_fn(4, 1, |x, _| x == 0);
    /// let grown = start.grown(|_, next| next != 2);
    /// assert_eq!(grown.cells(), [true, true, false, false]);
    /// ```
    pub fn grown(&self, joins: impl Fn(usize, usize) -> bool) -> Self {
        let mut reached = self.clone();
        let mut open: Vec<usize> = (0..self.cells.len()).filter(|&cell| self.cells[cell]).collect();
        while let Some(cell) = open.pop() {
            for next in self.beside(cell) {
                if !reached.cells[next] && joins(cell, next) {
                    reached.cells[next] = true;
                    open.push(next);
                }
            }
        }
        reached
    }

    /// The cells at the sides of a cell, all by their indices.
    pub(crate) fn beside(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.width, self.height);
        let (x, y) = (cell % width, cell / width);
        let left = (x > 0).then(|| cell - 1);
        let right = (x + 1 < width).then(|| cell + 1);
        let above = (y > 0).then(|| cell - width);
        let below = (y + 1 < height).then(|| cell + width);
        [left, right, above, below].into_iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outside_of_the_grid_there_is_nothing() {
        let mut grid = Raster::from_fn(2, 2, |x, y| 10 * y + x);
        assert_eq!(grid.get(1, 1), Some(11));
        assert_eq!(grid.get(2, 0), None);
        assert_eq!(grid.get(-1, 0), None);
        grid.set(5, 5, 1);
        assert!(grid.row(2).is_empty());
    }

    #[test]
    fn diagonal_neighbours_are_two_regions() {
        let (_, count) = Raster::from_fn(2, 2, |x, y| x == y).regions(true);
        assert_eq!(count, 2);
    }
}
