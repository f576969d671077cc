//! The free floor cut into trapezoids between neighbouring corners of its border.
//!
//! ```text
//!   ____________     A sweep from left to right draws, at every corner, a line up and down to the next
//!  |  |   \  |  |    border. Between two such lines lies a convex cell with one border below and one
//!  |  |    \_|  |    above; the lines are the portals from cell to cell.
//!  |__|____|_|__|
//! ```
//! Corners of one x are taken from below upwards, as if the arena were sheared a little: cells between
//! them have no width, which the search does not mind. A portal ends at a corner on one side at least;
//! where its other end lies inside a border edge it is rounded out of the free floor: a view is wider
//! there than it should be until it meets the corner at which that edge ends, and that corner cuts it
//! off before anything is decided. Lattice units.

use super::free_space::BorderEdge;
use crate::grid::{LatticePoint, LatticeRect, turn};
use crate::plan::exact::{Mesh, NO_CORNER, Portal, PortalEnd};

/// No cell, as a number.
const NOWHERE: u32 = u32::MAX;

/// A convex piece of the free floor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    lower: BorderEdge,
    upper: BorderEdge,
    /// Where the sweep was when the cell began and ended, x.
    x0: i32,
    x1: i32,
}

impl Cell {
    /// Whether `point` lies inside or on the edge.
    pub(super) fn contains(&self, point: LatticePoint) -> bool {
        // A vertical edge bounds a cell without width, on whose line every point lies.
        let is_vertical = |edge: &BorderEdge| edge.from.x == edge.to.x;
        let is_above = match is_vertical(&self.lower) {
            true => point.y >= self.lower.from.y,
            false => turn(self.lower.from, self.lower.to, point) >= 0,
        };
        let is_below = match is_vertical(&self.upper) {
            true => point.y <= self.upper.to.y,
            false => turn(self.upper.from, self.upper.to, point) <= 0,
        };
        self.x0 <= point.x && point.x <= self.x1 && is_above && is_below
    }

    /// The rectangle around it.
    pub(super) fn bounds(&self) -> LatticeRect {
        let ends = |edge: &BorderEdge| [self.x0, self.x1].map(|x| height(edge, x));
        let (low, high) = (ends(&self.lower), ends(&self.upper));
        LatticeRect::new(
            self.x0,
            low[0].floor().min(low[1].floor()) as i32,
            self.x1,
            high[0].ceil().max(high[1].ceil()) as i32,
        )
    }

    /// A point of the cell that is about as near to `point` as any; `None` if the lattice has none there.
    pub(super) fn nearest(&self, point: LatticePoint) -> Option<LatticePoint> {
        let x = f64::from(point.x).clamp(f64::from(self.x0), f64::from(self.x1));
        let foot = |edge: &BorderEdge| foot(edge, point, (self.x0, self.x1));
        let above = (x, height(&self.lower, x as i32).max(f64::from(point.y)));
        let straight = (x, above.1.min(height(&self.upper, x as i32)));
        let candidates = [straight, foot(&self.lower), foot(&self.upper)];
        let near = candidates.into_iter().flat_map(|(x, y)| {
            let (x, y) = (x.round() as i32, y.round() as i32);
            (-2..=2).flat_map(move |dx| (-2..=2).map(move |dy| LatticePoint::new(x + dx, y + dy)))
        });
        near.filter(|&at| self.contains(at))
            .min_by(|a, b| point.distance(*a).total_cmp(&point.distance(*b)))
    }
}

/// The height of the edge at `x`; of a vertical one, where it begins.
fn height(edge: &BorderEdge, x: i32) -> f64 {
    let (dx, dy) = edge.from.to(edge.to);
    if dx == 0 {
        return f64::from(edge.from.y);
    }
    let along = f64::from(x) - f64::from(edge.from.x);
    f64::from(edge.from.y) + along * dy as f64 / dx as f64
}

/// The point of the edge between two values of x that is nearest to `point`.
fn foot(edge: &BorderEdge, point: LatticePoint, (x0, x1): (i32, i32)) -> (f64, f64) {
    let (dx, dy) = edge.from.to(edge.to);
    let (px, py) = edge.from.to(point);
    let square = (dx * dx + dy * dy) as f64;
    let along = (px as f64 * dx as f64 + py as f64 * dy as f64) / square;
    let x = (f64::from(edge.from.x) + along * dx as f64).clamp(f64::from(x0), f64::from(x1));
    let share =
        if dx == 0 { along.clamp(0.0, 1.0) } else { (x - f64::from(edge.from.x)) / dx as f64 };
    (x, f64::from(edge.from.y) + share * dy as f64)
}

/// The cells of the free floor and the mesh of their portals.
pub(super) fn trapezoids(border: &[BorderEdge]) -> (Vec<Cell>, Mesh) {
    let mut sweep = Sweep::new(border);
    sweep.run();
    let Sweep { cells, portals, corners, .. } = sweep;
    let each = portals.iter().copied();
    let mesh = Mesh::new(cells.len(), 2 * corners.len(), each);
    (cells, mesh)
}

/// A corner of the border with the edges that end and begin there.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: LatticePoint,
    /// The edges that begin here are `begins[first..last]`, from the lowest to the highest.
    begins: (u32, u32),
    /// Whether a way can turn here: the border bends towards the free floor.
    is_turning: bool,
    /// Whether the floor below and the floor above it are apart here: shapes touch in it, or lie on one
    /// side. Ways to it from below and from above have nothing to do with each other.
    parts: bool,
}

struct Sweep<'a> {
    border: &'a [BorderEdge],
    corners: Vec<Corner>,
    /// Edges by where they begin, then by direction.
    begins: Vec<u32>,
    /// The edges that the sweep line meets, from below.
    status: Vec<u32>,
    /// By edge: the cell above it, [`NOWHERE`] if the floor there is not free.
    above: Vec<u32>,
    cells: Vec<Cell>,
    portals: Vec<(u32, Portal)>,
}

impl<'a> Sweep<'a> {
    fn new(border: &'a [BorderEdge]) -> Self {
        let mut begins: Vec<u32> = (0..border.len() as u32).collect();
        let edge = |index: u32| &border[index as usize];
        begins.sort_unstable_by(|&a, &b| {
            let (a, b) = (edge(a), edge(b));
            let side = || turn(a.from, a.to, b.to);
            a.from.cmp(&b.from).then_with(|| 0.cmp(&side()))
        });
        let mut ends: Vec<u32> = (0..border.len() as u32).collect();
        ends.sort_unstable_by_key(|&index| edge(index).to);
        let mut corners = Vec::with_capacity(border.len());
        let (mut begun, mut ended) = (0, 0);
        while begun < begins.len() || ended < ends.len() {
            let next = begins.get(begun).map(|&index| edge(index).from);
            let last = ends.get(ended).map(|&index| edge(index).to);
            let Some(at) = next.into_iter().chain(last).min() else { break };
            let count = |list: &[u32], end: fn(&BorderEdge) -> LatticePoint| {
                list.iter().take_while(|&&index| end(edge(index)) == at).count()
            };
            let starts = count(&begins[begun..], |edge| edge.from);
            let stops = count(&ends[ended..], |edge| edge.to);
            let meeting = begins[begun..begun + starts].iter().chain(&ends[ended..ended + stops]);
            let is_turning = is_turning(at, meeting.map(|&index| *edge(index)));
            let begins = (begun as u32, (begun + starts) as u32);
            corners.push(Corner { at, begins, is_turning, parts: starts > 0 && stops > 0 });
            begun += starts;
            ended += stops;
        }
        let above = vec![NOWHERE; border.len()];
        let status = Vec::new();
        Self { border, corners, begins, status, above, cells: vec![], portals: vec![] }
    }

    fn run(&mut self) {
        self.cells.reserve(2 * self.corners.len());
        self.portals.reserve(4 * self.corners.len());
        for number in 0..self.corners.len() {
            self.pass(number as u32);
        }
    }

    fn edge(&self, index: u32) -> &BorderEdge {
        &self.border[index as usize]
    }

    /// Takes the sweep line over one corner: closes the cells that end there, opens those that begin.
    fn pass(&mut self, number: u32) {
        let Corner { at, begins, .. } = self.corners[number as usize];
        let side = |edge: &u32| turn(self.edge(*edge).from, self.edge(*edge).to, at);
        let low = self.status.partition_point(|edge| side(edge) > 0);
        let ending = self.status[low..].iter().take_while(|&edge| side(edge) == 0).count();
        let high = low + ending;
        let below = low.checked_sub(1).map(|place| self.status[place]);
        let above = self.status.get(high).copied();
        let old_low = below.map_or(NOWHERE, |edge| self.above[edge as usize]);
        let last_ending = (ending > 0).then(|| self.status[high - 1]);
        let old_high = last_ending.map_or(old_low, |edge| self.above[edge as usize]);
        for &edge in below.iter().chain(&self.status[low..high]) {
            if let Some(cell) = self.cells.get_mut(self.above[edge as usize] as usize) {
                cell.x1 = at.x;
            }
        }
        let starting: Vec<u32> = self.begins[begins.0 as usize..begins.1 as usize].to_vec();
        let around: Vec<u32> = below.into_iter().chain(starting.iter().copied()).collect();
        for (place, &lower) in around.iter().enumerate() {
            let upper = around.get(place + 1).copied().or(above);
            let is_free = self.edge(lower).is_free_above;
            self.above[lower as usize] = match upper {
                Some(upper) if is_free => self.open(lower, upper, at.x),
                _ => NOWHERE,
            };
        }
        self.status.splice(low..high, starting.iter().copied());
        let new_low = below.map_or(NOWHERE, |edge| self.above[edge as usize]);
        let new_high = starting.last().map_or(new_low, |&edge| self.above[edge as usize]);
        let corner = |from| PortalEnd { at, corner: self.number_of(number, from) };
        let (under, over) = (corner(Seen::FromBelow), corner(Seen::FromAbove));
        if let Some(below) = below {
            let end = self.end_on(below, at.x, Seen::FromAbove);
            self.connect([old_low, new_low], [end, under]);
        }
        if let Some(above) = above {
            let end = self.end_on(above, at.x, Seen::FromBelow);
            self.connect([old_high, new_high], [over, end]);
        }
    }

    fn open(&mut self, lower: u32, upper: u32, x: i32) -> u32 {
        self.cells.push(Cell { lower: *self.edge(lower), upper: *self.edge(upper), x0: x, x1: x });
        self.cells.len() as u32 - 1
    }

    /// Adds the portal between the lower and the upper end, both ways, if floor on both sides is free.
    fn connect(&mut self, [left, right]: [u32; 2], [low, high]: [PortalEnd; 2]) {
        if left != NOWHERE && right != NOWHERE {
            self.portals.push((left, Portal::new(low, high, right)));
            self.portals.push((right, Portal::new(high, low, left)));
        }
    }

    /// The corner's number in the mesh, if a way can turn there.
    fn number_of(&self, corner: u32, seen: Seen) -> u32 {
        match self.corners[corner as usize] {
            Corner { is_turning: false, .. } => NO_CORNER,
            Corner { parts: true, .. } if seen == Seen::FromAbove => 2 * corner + 1,
            _ => 2 * corner,
        }
    }

    /// Where the sweep line at `x` meets `edge`, seen from the free floor below or above: the corner that
    /// stands there, or a point that is rounded out of the free floor.
    fn end_on(&self, edge: u32, x: i32, seen: Seen) -> PortalEnd {
        let edge = self.edge(edge);
        if let Some(at) = [edge.from, edge.to].into_iter().find(|corner| corner.x == x) {
            let place = self.corners.binary_search_by_key(&at, |corner| corner.at);
            let corner = place.map_or(NO_CORNER, |place| self.number_of(place as u32, seen));
            return PortalEnd { at, corner };
        }
        let y = height(edge, x);
        let y = if seen == Seen::FromAbove { y.floor() } else { y.ceil() };
        PortalEnd { at: LatticePoint::new(x, y as i32), corner: NO_CORNER }
    }
}

/// From which side a corner is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Seen {
    FromBelow,
    FromAbove,
}

/// Whether a shortest way can turn at `at`: between two of the edges that meet there the free floor takes
/// a half turn or more (at a half turn a way along a vertical wall goes on). Where more than two meet, it
/// is enough that it may.
fn is_turning(at: LatticePoint, edges: impl Iterator<Item = BorderEdge>) -> bool {
    let mut meeting = edges;
    let (Some(a), Some(b)) = (meeting.next(), meeting.next()) else { return false };
    if meeting.next().is_some() {
        return true;
    }
    // Seen from the corner along edge a, the free floor is on the left or on the right.
    let begins = a.from == at;
    let [a_end, b_end] = [a, b].map(|edge| if edge.from == at { edge.to } else { edge.from });
    let is_free_left = a.is_free_above == begins;
    let side = turn(at, a_end, b_end);
    // The other edge lies on the side that is not free.
    if is_free_left { side <= 0 } else { side >= 0 }
}

#[cfg(test)]
mod tests {
    use super::super::free_space::border_of_free_space;
    use super::*;
    use proptest::prelude::*;

    fn cut(contours: &[&[(i32, i32)]]) -> (Vec<Cell>, Mesh) {
        let contours: Vec<Vec<LatticePoint>> = contours
            .iter()
            .map(|contour| contour.iter().map(|&(x, y)| LatticePoint::new(x, y)).collect())
            .collect();
        trapezoids(&border_of_free_space(LatticeRect::new(0, 0, 100, 100), &contours))
    }

    fn components(mesh: &Mesh) -> usize {
        let mut all = mesh.components();
        all.sort_unstable();
        all.dedup();
        all.len()
    }

    #[test]
    fn an_empty_floor_is_one_cell_and_a_wall_makes_two_parts() {
        assert_eq!(components(&cut(&[]).1), 1);
        let wall: &[(i32, i32)] = &[(40, -5), (60, -5), (50, 105), (45, 105)];
        let (cells, mesh) = cut(&[wall]);
        assert_eq!(components(&mesh), 2);
        let holds = |x, y| cells.iter().any(|cell| cell.contains(LatticePoint::new(x, y)));
        assert!(holds(10, 10) && holds(90, 90) && !holds(50, 50));
    }

    #[test]
    fn two_triangles_whose_tips_touch_leave_no_gap() {
        let lower: &[(i32, i32)] = &[(20, -1), (80, -1), (50, 40)];
        let upper: &[(i32, i32)] = &[(20, 101), (50, 40), (80, 101)];
        assert_eq!(components(&cut(&[lower, upper]).1), 2);
        let apart: &[(i32, i32)] = &[(20, 101), (50, 41), (80, 101)];
        assert_eq!(components(&cut(&[lower, apart]).1), 1);
        // Tip against the middle of an edge, and side by side.
        let wedge: &[(i32, i32)] = &[(-1, 20), (50, 50), (-1, 80)];
        let plate: &[(i32, i32)] = &[(50, 0), (101, 0), (101, 100), (50, 100)];
        assert_eq!(components(&cut(&[wedge, plate]).1), 2);
    }

    #[test]
    fn a_corner_where_shapes_touch_is_two_to_the_search() {
        let left: &[(i32, i32)] = &[(-1, 30), (50, 50), (-1, 60)];
        let right: &[(i32, i32)] = &[(50, 50), (80, 40), (80, 60)];
        let (_, mesh) = cut(&[left, right]);
        let all = (0..mesh.pieces() as u32).flat_map(|piece| mesh.portals(piece));
        let ends = all.flat_map(|portal| [portal.left, portal.right]);
        let mut numbers: Vec<u32> =
            ends.filter(|end| end.at == LatticePoint::new(50, 50)).map(|end| end.corner).collect();
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers.len(), 2, "{numbers:?}");
    }

    proptest! {
        /// On a coarse lattice, so that corners of one x, vertical edges and touching shapes are many.
        #[test]
        fn cells_hold_exactly_the_points_that_no_triangle_holds(
            triangles in proptest::collection::vec(
                proptest::array::uniform3((0..9_i32, 0..9_i32)), 0..7),
        ) {
            let scaled = |p: (i32, i32)| LatticePoint::new(12 * p.0, 12 * p.1);
            let triangles: Vec<[LatticePoint; 3]> = triangles
                .iter()
                .map(|t| t.map(scaled))
                .filter(|t| turn(t[0], t[1], t[2]) != 0)
                .map(|t| if turn(t[0], t[1], t[2]) > 0 { t } else { [t[0], t[2], t[1]] })
                .collect();
            let contours: Vec<Vec<LatticePoint>> = triangles.iter().map(|t| t.to_vec()).collect();
            let border = border_of_free_space(LatticeRect::new(0, 0, 100, 100), &contours);
            let (cells, mesh) = trapezoids(&border);
            prop_assert_eq!(mesh.pieces(), cells.len());
            for (x, y) in (1..100).step_by(7).flat_map(|x| (1..100).step_by(7).map(move |y| (x, y))) {
                let at = LatticePoint::new(x, y);
                // Crossings are rounded by a unit: points that near to an edge are no evidence.
                let depth = |t: &[LatticePoint; 3]| {
                    (0..3).map(|i| {
                        let (a, b) = (t[i], t[(i + 1) % 3]);
                        turn(a, b, at) as f64 / a.distance(b)
                    }).fold(f64::INFINITY, f64::min)
                };
                let depths: Vec<f64> = triangles.iter().map(depth).collect();
                let is_held = cells.iter().any(|cell| cell.contains(at));
                if depths.iter().any(|&depth| depth > 2.0) {
                    prop_assert!(!is_held, "{at:?} is in a triangle");
                }
                if depths.iter().all(|&depth| depth < -2.0) {
                    prop_assert!(is_held, "{at:?} is free");
                }
            }
        }
    }
}
