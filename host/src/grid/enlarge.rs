//! Grows the obstacles by the robot's radius, so that the robot becomes a point [Alghannam, Sec. II-B].
//!
//! The paper's segment method lengthens every run of obstacle pixels in a row or column by the
//! radius at both ends; on rectangles that moves each edge out by the radius and keeps the corners
//! square. The arena's own borders move in by as much. Metres in, lattice units out.

use super::{GridError, LatticeRect};
use crate::geometry::Rect;
use crate::scene::Scene;

/// Distance to keep beyond the robot's radius, metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Margin {
    /// Around every obstacle and inside the arena's border.
    pub uniform: f64,
    /// In addition, how much further out each edge `[left, lower, right, upper]` of an obstacle may
    /// lie, by the obstacle's index; obstacles beyond the end of the list have none.
    pub per_obstacle: Vec<[f64; 4]>,
}

impl Margin {
    /// The same `metres` everywhere.
    pub fn uniform(metres: f64) -> Self {
        Self { uniform: metres, per_obstacle: Vec::new() }
    }
}

/// The arena as a point robot sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EnlargedArena {
    /// The arena's true border.
    pub border: LatticeRect,
    /// Where the robot's centre may be as far as the border is concerned.
    pub inside: LatticeRect,
    /// The grown obstacles in the scene's order; they may overlap and reach beyond the border.
    pub boxes: Vec<LatticeRect>,
}

/// Grows the obstacles of `scene` by its robot radius and `margin`, and shrinks the border by as much.
///
/// # Errors
/// [`GridError`] if a coordinate is too large, a margin is no distance, or the robot does not fit
/// between the borders.
///
/// ```
/// use wmr::{geometry::Rect, grid::{LatticeRect, Margin, enlarge}, scene::Scene};
/// let mut scene = Scene::new(1.0, 1.0);
/// scene.obstacles.push(Rect::new(0.4, 0.4, 0.6, 0.6));
/// let arena = enlarge(&scene, &Margin::default())?;
/// assert_eq!(arena.boxes, [LatticeRect::new(3250, 3250, 6750, 6750)]);
/// # Ok::<(), wmr::grid::GridError>(())
/// ```
pub fn enlarge(scene: &Scene, margin: &Margin) -> Result<EnlargedArena, GridError> {
    check(margin)?;
    let by = scene.robot_radius + margin.uniform;
    let floor = Rect::new(0.0, 0.0, scene.arena.width, scene.arena.height);
    let too_large = |rect: Rect| GridError::TooLarge { rect };
    let border = LatticeRect::outwards(floor, [0.0; 4]).ok_or(too_large(floor))?;
    let inside = LatticeRect::inwards(floor, by).ok_or(too_large(floor))?;
    if !inside.has_area() {
        return Err(GridError::ArenaTooSmall { arena: scene.arena, need: 2.0 * by });
    }
    let grow = |(index, &rect): (usize, &Rect)| {
        let own = margin.per_obstacle.get(index).copied().unwrap_or_default();
        LatticeRect::outwards(rect, own.map(|edge| edge + by)).ok_or(too_large(rect))
    };
    let boxes = scene.obstacles.iter().enumerate().map(grow).collect::<Result<_, _>>()?;
    Ok(EnlargedArena { border, inside, boxes })
}

fn check(margin: &Margin) -> Result<(), GridError> {
    let all = margin.per_obstacle.iter().flatten().chain([&margin.uniform]);
    match all.copied().find(|metres| !(metres.is_finite() && *metres >= 0.0)) {
        Some(metres) => Err(GridError::Margin { metres }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_edge_moves_by_radius_margin_and_its_own_uncertainty() {
        let mut scene = Scene::new(2.0, 1.0);
        scene.obstacles.push(Rect::new(1.0, 0.4, 1.2, 0.5));
        let margin = Margin { uniform: 0.01, per_obstacle: vec![[0.001, 0.002, 0.003, 0.004]] };
        let arena = enlarge(&scene, &margin).unwrap();
        assert_eq!(arena.boxes, [LatticeRect::new(9140, 3130, 12880, 5890)]);
        assert_eq!(arena.inside, LatticeRect::new(850, 850, 19150, 9150));
        assert_eq!(arena.border, LatticeRect::new(0, 0, 20_000, 10_000));
    }

    #[test]
    fn a_robot_wider_than_the_arena_is_refused_with_both_sizes() {
        let error = enlarge(&Scene::new(2.0, 0.15), &Margin::default()).unwrap_err();
        assert!(error.to_string().contains("15.0 cm"), "{error}");
    }

    #[test]
    fn a_negative_margin_is_refused() {
        let error = enlarge(&Scene::new(2.0, 2.0), &Margin::uniform(-0.01)).unwrap_err();
        assert!(matches!(error, GridError::Margin { metres: -0.01 }));
    }
}
