//! The mini-matrix mM: one element per area between the border lines [Alghannam, Sec. III].
//!
//! 0 = the robot's centre cannot be there, 1 = available, 2 = holds start or goal. Row 0 is the top
//! row, as in the picture; areas are numbered from 1, row by row from the top left, the dead ring
//! along the arena's border included. Lattice units.

use super::{BorderLines, EnlargedArena, GridError, LatticePoint, LatticeRect};

/// One rectangle between neighbouring border lines, by its place in the mini-matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Area(pub(super) usize);

impl Area {
    /// The area's place in row order, from 0.
    pub fn index(self) -> usize {
        self.0
    }

    /// The paper's number of the area, from 1.
    pub fn number(self) -> usize {
        self.0 + 1
    }
}

/// What an element of the mini-matrix says of its area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AreaKind {
    /// Unavailable: blocked, outside, or closed as a trap.
    Dead,
    /// The robot may pass.
    Available,
    /// Holds the start or the goal.
    Terminal,
}

impl AreaKind {
    /// The paper's element: 0, 1 or 2.
    pub fn element(self) -> u8 {
        match self {
            Self::Dead => 0,
            Self::Available => 1,
            Self::Terminal => 2,
        }
    }
}

/// The areas of an arena and which of them the robot may use.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MiniMatrix {
    lines: BorderLines,
    kinds: Vec<AreaKind>,
}

/// Columns and rows of the eight neighbours, counter-clockwise from the right one.
const AROUND: [(isize, isize); 8] =
    [(1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1)];

impl MiniMatrix {
    /// The mini-matrix of `arena`; no area is a terminal yet.
    ///
    /// # Errors
    /// [`GridError::TooManyAreas`] if the grid would not fit into memory.
    ///
    /// ```
    /// use wmr::{geometry::Rect, grid::{MiniMatrix, enlarge}, scene::Scene};
    /// let mut scene = Scene::new(1.0, 1.0);
    /// scene.obstacles.push(Rect::new(0.4, 0.0, 0.6, 0.5).into());
    /// let matrix = MiniMatrix::from_borders(&enlarge(&scene, 0.0)?)?;
    /// assert_eq!(matrix.elements(), [
    ///     [0, 0, 0, 0, 0],
    ///     [0, 1, 1, 1, 0],
    ///     [0, 1, 0, 1, 0],
    ///     [0, 0, 0, 0, 0],
    /// ]);
    /// # Ok::<(), wmr::grid::GridError>(())
    /// ```
    pub fn from_borders(arena: &EnlargedArena) -> Result<Self, GridError> {
        let lines = BorderLines::of(arena)?;
        let count = (lines.xs.len() - 1) * (lines.ys.len() - 1);
        let mut matrix = Self { lines, kinds: vec![AreaKind::Available; count] };
        matrix.kill_ring(arena.inside);
        for &grown in &arena.boxes {
            matrix.kill_inside(grown.intersection(arena.inside));
        }
        Ok(matrix)
    }

    /// Everything nearer to the arena's border than the robot's radius is dead.
    fn kill_ring(&mut self, inside: LatticeRect) {
        for area in self.areas() {
            if !inside.intersection(self.rect(area)).has_area() {
                self.kinds[area.0] = AreaKind::Dead;
            }
        }
    }

    fn kill_inside(&mut self, rect: LatticeRect) {
        let (columns, rows) = (self.columns(), self.rows());
        let first = self.lines.xs.partition_point(|&x| x < rect.x0);
        let last = self.lines.xs.partition_point(|&x| x < rect.x1);
        let low = self.lines.ys.partition_point(|&y| y < rect.y0);
        let high = self.lines.ys.partition_point(|&y| y < rect.y1);
        // A hidden edge is no line: then the box covers the area by parts only together with others.
        let first = if self.lines.xs.get(first) == Some(&rect.x0) {
            first
        } else {
            first.saturating_sub(1)
        };
        let low =
            if self.lines.ys.get(low) == Some(&rect.y0) { low } else { low.saturating_sub(1) };
        if rect.has_area() {
            for line in low..high {
                let row = rows - 1 - line;
                self.kinds[row * columns + first..row * columns + last].fill(AreaKind::Dead);
            }
        }
    }

    /// Marks the area that holds `point` as a terminal and returns it. On a line between areas an
    /// available one is taken; `None` if there is none.
    pub fn mark_terminal(&mut self, point: LatticePoint) -> Option<Area> {
        let holds = |area: &Area| self.is_live(*area) && self.rect(*area).contains(point);
        let area = self.areas_near(point).find(holds)?;
        self.kinds[area.0] = AreaKind::Terminal;
        Some(area)
    }

    /// The up to four areas that `point` may touch.
    fn areas_near(&self, point: LatticePoint) -> impl Iterator<Item = Area> {
        let (columns, rows) = (self.columns(), self.rows());
        let column = self.lines.xs.partition_point(|&x| x < point.x);
        let line = self.lines.ys.partition_point(|&y| y < point.y);
        let across = column.saturating_sub(1)..(column + 1).min(columns);
        (line.saturating_sub(1)..(line + 1).min(rows)).rev().flat_map(move |line| {
            across.clone().map(move |column| Area((rows - 1 - line) * columns + column))
        })
    }

    /// The lines that bound the areas.
    pub fn lines(&self) -> &BorderLines {
        &self.lines
    }

    /// How many areas stand side by side.
    pub fn columns(&self) -> usize {
        self.lines.xs.len() - 1
    }

    /// How many areas lie one upon the other.
    pub fn rows(&self) -> usize {
        self.lines.ys.len() - 1
    }

    /// All areas, in the order of their numbers.
    pub fn areas(&self) -> impl Iterator<Item = Area> + use<> {
        (0..self.kinds.len()).map(Area)
    }

    /// What the matrix says of `area`.
    pub fn kind(&self, area: Area) -> AreaKind {
        self.kinds[area.0]
    }

    /// Whether the robot may use `area`.
    pub fn is_live(&self, area: Area) -> bool {
        self.kind(area) != AreaKind::Dead
    }

    pub(super) fn close(&mut self, area: Area) {
        self.kinds[area.0] = AreaKind::Dead;
    }

    /// The rectangle of `area`.
    pub fn rect(&self, area: Area) -> LatticeRect {
        let (column, row) = self.place(area);
        let line = self.rows() - 1 - row;
        let (xs, ys) = (&self.lines.xs, &self.lines.ys);
        LatticeRect::new(xs[column], ys[line], xs[column + 1], ys[line + 1])
    }

    /// Column from the left and row from the top, from 0.
    pub fn place(&self, area: Area) -> (usize, usize) {
        (area.0 % self.columns(), area.0 / self.columns())
    }

    /// The eight areas around `area`, counter-clockwise from the right one; `None` outside the arena.
    pub fn around(&self, area: Area) -> [Option<Area>; 8] {
        let (column, row) = self.place(area);
        AROUND.map(|(dx, dy)| {
            let column = column.checked_add_signed(dx).filter(|&c| c < self.columns())?;
            let row = row.checked_add_signed(dy).filter(|&r| r < self.rows())?;
            Some(Area(row * self.columns() + column))
        })
    }

    /// The areas that the robot may enter from `area`.
    ///
    /// Deviation: the paper allows every diagonal step; here one of the two areas beside it must be
    /// live, or the robot would squeeze through between two obstacles that touch at a corner.
    pub fn next_areas(&self, area: Area) -> impl Iterator<Item = Area> {
        let around = self.around(area);
        let live = around.map(|next| next.is_some_and(|next| self.is_live(next)));
        (0..8).filter_map(move |i| {
            let beside = i % 2 == 0 || live[(i + 7) % 8] || live[(i + 1) % 8];
            around[i].filter(|_| live[i] && beside)
        })
    }

    /// The matrix as numbers 0, 1, 2; row 0 is the top row.
    pub fn elements(&self) -> Vec<Vec<u8>> {
        let row = |kinds: &[AreaKind]| kinds.iter().map(|kind| kind.element()).collect();
        self.kinds.chunks(self.columns()).map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(boxes: &[[i32; 4]]) -> MiniMatrix {
        let boxes = boxes.iter().map(|&[a, b, c, d]| LatticeRect::new(a, b, c, d)).collect();
        let whole = LatticeRect::new(0, 0, 6, 6);
        MiniMatrix::from_borders(&EnlargedArena::new(whole, whole, boxes)).unwrap()
    }

    #[test]
    fn a_hidden_edge_leaves_no_hole() {
        let crossed = matrix(&[[1, 2, 5, 4], [2, 1, 4, 5]]);
        assert_eq!(crossed.elements().concat().iter().filter(|&&e| e == 0).count(), 5);
        let nested = matrix(&[[1, 1, 5, 5], [2, 2, 3, 3]]);
        assert_eq!(nested.elements(), [[1, 1, 1], [1, 0, 1], [1, 1, 1]]);
    }

    #[test]
    fn numbers_run_from_the_top_left() {
        let matrix = matrix(&[[2, 2, 4, 4]]);
        let top_right = Area(2);
        assert_eq!(matrix.rect(top_right), LatticeRect::new(4, 4, 6, 6));
        assert_eq!(top_right.number(), 3);
    }

    #[test]
    fn a_diagonal_between_two_touching_boxes_is_no_way() {
        let touching = matrix(&[[0, 0, 3, 3], [3, 3, 6, 6]]);
        assert_eq!(touching.elements(), [[1, 0], [0, 1]]);
        assert_eq!(touching.next_areas(Area(0)).count(), 0);
        let open = matrix(&[[0, 0, 3, 3]]);
        assert!(open.next_areas(Area(0)).any(|next| next == Area(3)));
    }

    #[test]
    fn a_terminal_on_a_line_takes_an_available_area() {
        let mut matrix = matrix(&[[2, 2, 4, 4]]);
        let area = matrix.mark_terminal(LatticePoint::new(4, 3)).unwrap();
        assert_eq!(matrix.rect(area), LatticeRect::new(4, 2, 6, 4));
        assert_eq!(matrix.kind(area), AreaKind::Terminal);
        assert_eq!(matrix.mark_terminal(LatticePoint::new(3, 3)), None);
    }
}
