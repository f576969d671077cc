//! The lines through the borders of the enlarged obstacles [Alghannam, Sec. III].
//!
//! A line is drawn for every border that can be *seen*: an edge hidden inside another obstacle, or
//! outside the arena, draws none. Every rectangle between neighbouring lines is then wholly free or
//! wholly blocked. Lattice units.

use super::{EnlargedArena, GridError, LatticeRect};

/// The most areas that a grid may have; 1 000 boxes make at most 4 million.
pub const AREA_LIMIT: usize = 6_000_000;

/// The grid that the visible borders draw over the arena.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BorderLines {
    /// Where vertical lines stand, ascending; the first and last are the arena's own borders.
    pub xs: Vec<i32>,
    /// Where horizontal lines lie, ascending; the first and last are the arena's own borders.
    pub ys: Vec<i32>,
}

impl BorderLines {
    /// The lines through the visible borders of `arena`.
    ///
    /// # Errors
    /// [`GridError::TooManyAreas`] beyond [`AREA_LIMIT`].
    ///
    /// ```
    /// use wmr::{geometry::Rect, grid::{BorderLines, enlarge}, scene::Scene};
    /// let mut scene = Scene::new(1.0, 1.0);
    /// scene.obstacles.push(Rect::new(0.4, 0.0, 0.6, 0.5).into());
    /// let lines = BorderLines::of(&enlarge(&scene, 0.0)?)?;
    /// assert_eq!(lines.xs, [0, 750, 3250, 6750, 9250, 10_000]);
    /// assert_eq!(lines.ys, [0, 750, 5750, 9250, 10_000]);
    /// # Ok::<(), wmr::grid::GridError>(())
    /// ```
    pub fn of(arena: &EnlargedArena) -> Result<Self, GridError> {
        let edges = Occupancy::of(arena)?;
        let mut xs = edges.visible_columns();
        let mut ys = edges.visible_rows();
        add_border(&mut xs, arena.border.x0, arena.border.x1);
        add_border(&mut ys, arena.border.y0, arena.border.y1);
        Ok(Self { xs, ys })
    }
}

/// The arena's own border, unless the robot has no width and may drive along it.
fn add_border(lines: &mut Vec<i32>, low: i32, high: i32) {
    if lines.first().is_some_and(|&first| low < first) {
        lines.insert(0, low);
    }
    if lines.last().is_some_and(|&last| last < high) {
        lines.push(high);
    }
}

/// Which rectangles between *all* edges, seen and hidden, are blocked.
struct Occupancy {
    xs: Vec<i32>,
    ys: Vec<i32>,
    /// Row by row from below.
    blocked: Vec<bool>,
}

impl Occupancy {
    fn of(arena: &EnlargedArena) -> Result<Self, GridError> {
        let inside = arena.inside;
        let seen: Vec<LatticeRect> = arena.boxes.iter().map(|b| b.intersection(inside)).collect();
        let seen = || seen.iter().filter(|rect| rect.has_area());
        let xs = sorted(seen().flat_map(|b| [b.x0, b.x1]).chain([inside.x0, inside.x1]));
        let ys = sorted(seen().flat_map(|b| [b.y0, b.y1]).chain([inside.y0, inside.y1]));
        let areas = (xs.len() - 1) * (ys.len() - 1);
        if areas > AREA_LIMIT {
            return Err(GridError::TooManyAreas { areas, limit: AREA_LIMIT });
        }
        let mut blocked = vec![false; areas];
        let columns = xs.len() - 1;
        for rect in seen() {
            let across = position(&xs, rect.x0)..position(&xs, rect.x1);
            for row in position(&ys, rect.y0)..position(&ys, rect.y1) {
                blocked[row * columns..][across.clone()].fill(true);
            }
        }
        Ok(Self { xs, ys, blocked })
    }

    fn visible_columns(&self) -> Vec<i32> {
        let columns = self.xs.len() - 1;
        let seen =
            |line: usize| self.blocked.chunks_exact(columns).any(|row| row[line - 1] != row[line]);
        keep_visible(&self.xs, seen)
    }

    fn visible_rows(&self) -> Vec<i32> {
        let columns = self.xs.len() - 1;
        let row = |index: usize| &self.blocked[index * columns..(index + 1) * columns];
        keep_visible(&self.ys, |line| row(line - 1) != row(line))
    }
}

/// The first and last line and those between that are `seen`.
fn keep_visible(lines: &[i32], seen: impl Fn(usize) -> bool) -> Vec<i32> {
    let last = lines.len() - 1;
    (0..=last).filter(|&i| i == 0 || i == last || seen(i)).map(|i| lines[i]).collect()
}

fn sorted(values: impl Iterator<Item = i32>) -> Vec<i32> {
    let mut values: Vec<i32> = values.collect();
    values.sort_unstable();
    values.dedup();
    values
}

/// The index of `value`, which is among `lines`.
fn position(lines: &[i32], value: i32) -> usize {
    lines.partition_point(|&line| line < value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arena(boxes: &[[i32; 4]]) -> EnlargedArena {
        let (border, inside) = (LatticeRect::new(0, 0, 10, 10), LatticeRect::new(1, 1, 9, 9));
        let boxes = boxes.iter().map(|&[a, b, c, d]| LatticeRect::new(a, b, c, d)).collect();
        EnlargedArena::new(border, inside, boxes)
    }

    #[test]
    fn an_edge_hidden_in_another_box_draws_no_line() {
        // The second box starts inside the first; its left edge at 4 is hidden.
        let lines = BorderLines::of(&arena(&[[3, 3, 5, 7], [4, 4, 7, 6]])).unwrap();
        assert_eq!(lines.xs, [0, 1, 3, 5, 7, 9, 10]);
        assert_eq!(lines.ys, [0, 1, 3, 4, 6, 7, 9, 10]);
    }

    #[test]
    fn an_edge_shared_by_two_boxes_draws_no_line() {
        let lines = BorderLines::of(&arena(&[[2, 2, 4, 4], [4, 2, 6, 4]])).unwrap();
        assert_eq!(lines.xs, [0, 1, 2, 6, 9, 10]);
    }

    #[test]
    fn a_box_outside_the_arena_draws_no_line() {
        let lines = BorderLines::of(&arena(&[[20, 20, 30, 30], [-5, -5, 1, 1]])).unwrap();
        assert_eq!(lines.xs, [0, 1, 9, 10]);
    }
}
