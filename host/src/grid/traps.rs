//! Closes un-useful areas, so that no way leads into a local minimum [Alghannam, Sec. III].
//!
//! The paper closes an area that is "almost surrounded by zeros", considering their position, unless
//! it holds start or goal, and repeats until nothing changes; in its experiment such areas have six
//! zeros among their eight neighbours.
//!
//! Deviation: taken literally, six zeros would close every corridor one area wide. Here an area is a
//! trap if at least six of its neighbours are zero (outside the arena counts as zero) *and* the live
//! ones form one run around it: then they are neighbours of one another, the area lies between no
//! two others, and closing it cuts no way.

use super::{Area, AreaKind, MiniMatrix};

/// Zeros among the eight neighbours that make an area "almost surrounded".
const ALMOST_SURROUNDED: usize = 6;

/// Closes traps until nothing changes and returns them in the order of closing.
///
/// ```
/// use wmr::{geometry::{Point, Rect}, grid::{MiniMatrix, close_traps, enlarge}, scene::Scene};
/// let mut scene = Scene::new(1.0, 1.0);
/// scene.obstacles.push(Rect::new(0.4, 0.0, 0.6, 0.5).into()); // leaves a dead end on either side
/// let mut matrix = MiniMatrix::from_borders(&enlarge(&scene, 0.0)?)?;
/// let closed: Vec<usize> = close_traps(&mut matrix).iter().map(|area| area.number()).collect();
/// assert_eq!(closed[..2], [12, 14]);
/// # Ok::<(), wmr::grid::GridError>(())
/// ```
pub fn close_traps(matrix: &mut MiniMatrix) -> Vec<Area> {
    let mut closed = Vec::new();
    let mut candidates: Vec<Area> = matrix.areas().collect();
    loop {
        let traps: Vec<Area> =
            candidates.into_iter().filter(|&area| is_trap(matrix, area)).collect();
        if traps.is_empty() {
            return closed;
        }
        traps.iter().for_each(|&area| matrix.close(area));
        // Only beside a closed area can anything have changed.
        candidates = traps.iter().flat_map(|&area| matrix.around(area)).flatten().collect();
        candidates.sort_unstable();
        candidates.dedup();
        closed.extend(traps);
    }
}

fn is_trap(matrix: &MiniMatrix, area: Area) -> bool {
    if matrix.kind(area) != AreaKind::Available {
        return false;
    }
    let live = matrix.around(area).map(|next| next.is_some_and(|next| matrix.is_live(next)));
    let zeros = live.iter().filter(|&&live| !live).count();
    let runs = (0..8).filter(|&i| live[i] && !live[(i + 1) % 8]).count();
    zeros >= ALMOST_SURROUNDED && runs <= 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{EnlargedArena, LatticePoint, LatticeRect};

    fn matrix(size: i32, boxes: &[[i32; 4]]) -> MiniMatrix {
        let boxes = boxes.iter().map(|&[a, b, c, d]| LatticeRect::new(a, b, c, d)).collect();
        let whole = LatticeRect::new(0, 0, size, size);
        MiniMatrix::from_borders(&EnlargedArena::new(whole, whole, boxes)).unwrap()
    }

    #[test]
    fn a_corridor_one_area_wide_stays_open() {
        let mut corridor = matrix(6, &[[0, 2, 3, 4], [4, 2, 6, 4]]);
        corridor.mark_terminal(LatticePoint::new(3, 1));
        corridor.mark_terminal(LatticePoint::new(3, 5));
        close_traps(&mut corridor);
        assert_eq!(corridor.elements()[1], [0, 1, 0]);
    }

    #[test]
    fn a_dead_end_closes_from_its_inner_end_but_never_a_terminal() {
        let pocket = [[0, 1, 6, 2], [0, 3, 6, 6], [0, 0, 3, 1]];
        let mut open = matrix(6, &pocket);
        assert_eq!(open.elements(), [[0, 0], [1, 1], [0, 0], [0, 1]]);
        close_traps(&mut open);
        assert_eq!(open.elements(), [[0, 0], [0, 0], [0, 0], [0, 0]]);
        let mut with_goal = matrix(6, &pocket);
        with_goal.mark_terminal(LatticePoint::new(1, 3));
        close_traps(&mut with_goal);
        assert_eq!(with_goal.elements()[1], [2, 0]);
    }
}
