//! Inflates the obstacles by the robot's radius, so that the robot becomes a point
//! [Alghannam, Sec. II-B].
//!
//! The paper's segment method lengthens every run of obstacle pixels in a row or column by the
//! radius at both ends; on rectangles that moves each edge out by the radius and keeps the corners
//! square. Any other shape is first covered by rectangles, as its pixels would be, and each of them is
//! inflated. The arena's own borders move in by as much. Metres in, lattice units out.

use super::{GridError, LatticeRect};
use crate::geometry::Rect;
use crate::scene::{Obstacle, Scene};

/// The height of the rectangles that cover a shape, metres: what a picture of 100 pixels a metre shows.
const COVER_STEP: f64 = 0.01;

/// The most rows of rectangles that cover one shape; a larger shape has higher ones.
const COVER_ROWS: f64 = 64.0;

/// The arena as a point robot sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EnlargedArena {
    /// The arena's true border.
    pub border: LatticeRect,
    /// Where the robot's centre may be as far as the border is concerned.
    pub inside: LatticeRect,
    /// The inflated obstacles in the scene's order; they may overlap and reach beyond the border.
    pub boxes: Vec<LatticeRect>,
    /// By box: the index of the obstacle in the scene that it is a part of.
    pub owners: Vec<usize>,
}

impl EnlargedArena {
    /// The arena whose obstacles are one inflated box each.
    pub fn new(border: LatticeRect, inside: LatticeRect, boxes: Vec<LatticeRect>) -> Self {
        Self { border, inside, owners: (0..boxes.len()).collect(), boxes }
    }
}

/// Inflates the obstacles of `scene` by its robot radius, `margin` (metres) and their own margins, and
/// shrinks the border by radius and margin.
///
/// # Errors
/// [`GridError`] if a coordinate is too large, a margin is no distance, or the robot does not fit
/// between the borders.
///
/// ```
/// use wmr::{geometry::Rect, grid::{LatticeRect, enlarge}, scene::Scene};
/// let mut scene = Scene::new(1.0, 1.0);
/// scene.obstacles.push(Rect::new(0.4, 0.4, 0.6, 0.6).into());
/// let arena = enlarge(&scene, 0.0)?;
/// assert_eq!(arena.boxes, [LatticeRect::new(3250, 3250, 6750, 6750)]);
/// # Ok::<(), wmr::grid::GridError>(())
/// ```
pub fn enlarge(scene: &Scene, margin: f64) -> Result<EnlargedArena, GridError> {
    if !(margin.is_finite() && margin >= 0.0) {
        return Err(GridError::Margin { metres: margin });
    }
    let by = scene.robot_radius + margin;
    let floor = Rect::new(0.0, 0.0, scene.arena.width, scene.arena.height);
    let too_large = |rect: Rect| GridError::TooLarge { rect };
    let border = LatticeRect::outwards(floor, [0.0; 4]).ok_or(too_large(floor))?;
    let inside = LatticeRect::inwards(floor, by).ok_or(too_large(floor))?;
    if !inside.has_area() {
        return Err(GridError::ArenaTooSmall { arena: scene.arena, need: 2.0 * by });
    }
    let mut arena = EnlargedArena {
        border,
        inside,
        boxes: Vec::with_capacity(scene.obstacles.len()),
        owners: Vec::with_capacity(scene.obstacles.len()),
    };
    for (owner, obstacle) in scene.obstacles.iter().enumerate() {
        let by = obstacle.margin.map(|edge| edge + by);
        for rect in cover(obstacle) {
            arena.boxes.push(LatticeRect::outwards(rect, by).ok_or(too_large(rect))?);
            arena.owners.push(owner);
        }
    }
    Ok(arena)
}

fn cover(obstacle: &Obstacle) -> Vec<Rect> {
    let bounds = obstacle.footprint.bounds();
    obstacle.footprint.cover(COVER_STEP.max((bounds.y1 - bounds.y0) / COVER_ROWS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::shape::Polygon;

    #[test]
    fn each_edge_moves_by_radius_margin_and_its_own_uncertainty() {
        let mut scene = Scene::new(2.0, 1.0);
        let margin = [0.001, 0.002, 0.003, 0.004];
        scene.obstacles.push(Obstacle { margin, ..Rect::new(1.0, 0.4, 1.2, 0.5).into() });
        let arena = enlarge(&scene, 0.01).unwrap();
        assert_eq!(arena.boxes, [LatticeRect::new(9140, 3130, 12880, 5890)]);
        assert_eq!(arena.inside, LatticeRect::new(850, 850, 19150, 9150));
        assert_eq!(arena.border, LatticeRect::new(0, 0, 20_000, 10_000));
    }

    #[test]
    fn a_robot_wider_than_the_arena_is_refused_with_both_sizes() {
        let error = enlarge(&Scene::new(2.0, 0.15), 0.0).unwrap_err();
        assert!(error.to_string().contains("15.0 cm"), "{error}");
    }

    #[test]
    fn a_negative_margin_is_refused() {
        let error = enlarge(&Scene::new(2.0, 2.0), -0.01).unwrap_err();
        assert!(matches!(error, GridError::Margin { metres: -0.01 }));
    }

    #[test]
    fn a_turned_shape_is_covered_row_by_row_and_each_row_is_inflated() {
        let mut scene = Scene::new(2.0, 1.0);
        let corners = [[1.0, 0.4], [1.02, 0.4], [1.0, 0.42]].map(Point::from).to_vec();
        scene.obstacles.push(Polygon::new(corners).unwrap().into());
        let arena = enlarge(&scene, 0.0).unwrap();
        let rows = [
            LatticeRect::new(9250, 3250, 10_950, 4850),
            LatticeRect::new(9250, 3350, 10_850, 4950),
        ];
        assert_eq!((arena.boxes.as_slice(), arena.owners.as_slice()), (&rows[..], &[0, 0][..]));
    }
}
