//! The exact shortest path by interval search (Polyanya; Cui, Harabor, Grastien, IJCAI 2017).
//!
//! A node of the search is what a robot standing at a *root* (the start, or a box's corner where the
//! way turned) sees through one portal: a cone between a right and a left ray. Going on through the
//! piece beyond, the cone splits over the piece's other portals; at a portal's end that is a box's
//! corner the way may turn, and the corner becomes the new root.
//!
//! Rays are kept as integer directions from the root to the corner that bounds the view, so every
//! decision is the sign of a cross product of integers. Nothing is decided on rounded numbers: with
//! three corners on one ray, a rounded interval end lets the shortest way slip through a crack of
//! 1e-15. Lengths, which only rank nodes, are `f64`. Lattice units.

use super::super::ranked::Ranked;
use super::mesh::{Mesh, Portal, PortalEnd};
use crate::grid::LatticePoint;
use std::collections::BinaryHeap;

/// The number of the start among the roots, where corners have the numbers of their vertices.
const START: u32 = u32::MAX;

/// Two ways to one corner whose lengths differ by less than this part are equally good.
const EQUAL: f64 = 1e-12;

/// A direction from the root, in units.
type Ray = (i64, i64);

fn cross(a: Ray, b: Ray) -> i64 {
    a.0 * b.1 - a.1 * b.0
}

/// Where a cone begins: the start or a corner at which the way turned.
#[derive(Clone, Copy, Debug)]
struct Root {
    at: LatticePoint,
    vertex: u32,
    /// The length of the way up to here.
    length: f64,
}

/// What can be seen from a root through a portal.
#[derive(Clone, Copy, Debug)]
struct View {
    /// The rays that bound the view.
    right: Ray,
    left: Ray,
    /// Whether a ray passes exactly through the portal's right and left end.
    right_at_end: bool,
    left_at_end: bool,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    root: Root,
    portal: Portal,
    /// `None` if the root is an end of the portal, or in line with it: all of the piece is in view.
    view: Option<View>,
}

/// The best way known to a corner.
#[derive(Clone, Copy, Debug)]
struct Reached {
    length: f64,
    parent: u32,
    at: LatticePoint,
    /// The query that this belongs to.
    query: u32,
}

/// The memory of searches on one mesh, kept from query to query.
#[derive(Clone, Debug, Default)]
pub(super) struct Search {
    reached: Vec<Reached>,
    query: u32,
    nodes: Vec<Node>,
    queue: BinaryHeap<Ranked>,
    /// The nodes that one expansion makes.
    made: Vec<Node>,
}

/// The ends of a query and the pieces that hold them, edges included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Query<'a> {
    pub(super) start: LatticePoint,
    pub(super) goal: LatticePoint,
    pub(super) start_pieces: &'a [u32],
    pub(super) goal_pieces: &'a [u32],
}

/// The best whole way known so far.
#[derive(Clone, Copy, Debug)]
struct Best {
    length: f64,
    /// The last root before the goal.
    root: u32,
}

impl Search {
    /// The points of the shortest way, start and goal included; `None` if there is no way.
    pub(super) fn shortest(&mut self, mesh: &Mesh, query: &Query) -> Option<Vec<LatticePoint>> {
        if query.start_pieces.iter().any(|piece| query.goal_pieces.contains(piece)) {
            return Some(vec![query.start, query.goal]);
        }
        self.prepare(mesh);
        let mut best = Best { length: f64::INFINITY, root: START };
        self.leave_start(mesh, query);
        self.enqueue(query, best.length);
        while let Some(Ranked { cost, index }) = self.queue.pop() {
            if cost >= best.length {
                break;
            }
            let mut node = self.nodes[index];
            // A node with a single successor is followed at once, without the queue.
            loop {
                if self.is_outdone(&node.root) {
                    break;
                }
                self.made.clear();
                if query.goal_pieces.contains(&node.portal.beyond) {
                    self.arrive(&node, query.goal, &mut best);
                }
                self.expand(mesh, &node, query);
                match self.made[..] {
                    [only] => node = only,
                    _ => break self.enqueue(query, best.length),
                }
            }
        }
        best.length.is_finite().then(|| self.trace(query, best.root))
    }

    fn prepare(&mut self, mesh: &Mesh) {
        self.query = self.query.wrapping_add(1);
        if self.reached.len() < mesh.vertices || self.query == 0 {
            let unreached =
                Reached { length: 0.0, parent: START, at: LatticePoint::new(0, 0), query: 0 };
            self.reached = vec![unreached; mesh.vertices];
            self.query = 1;
        }
        self.nodes.clear();
        self.queue.clear();
        self.made.clear();
    }

    /// The views out of the pieces that hold the start.
    fn leave_start(&mut self, mesh: &Mesh, query: &Query) {
        let start = Root { at: query.start, vertex: START, length: 0.0 };
        for portal in query.start_pieces.iter().flat_map(|&piece| mesh.portals(piece)) {
            // Through a portal that the start lies on, the next piece holds the start too.
            let (u, w) = (start.at.to(portal.right.at), start.at.to(portal.left.at));
            let is_on = cross(u, w) == 0 && u.0 * w.0 + u.1 * w.1 <= 0;
            if !is_on && !query.start_pieces.contains(&portal.beyond) {
                self.see(start, portal, u, w);
            }
        }
    }

    /// Adds the nodes behind the portals of the piece that `node` enters.
    fn expand(&mut self, mesh: &Mesh, node: &Node, query: &Query) {
        let entered = &node.portal;
        let portals = mesh.portals(entered.beyond);
        let is_back = |portal: &Portal| {
            portal.right.vertex == entered.left.vertex && portal.left.vertex == entered.right.vertex
        };
        let useful = |portal: &&Portal| {
            !is_back(portal)
                && (mesh.portals(portal.beyond).len() > 1
                    || query.goal_pieces.contains(&portal.beyond))
        };
        let Some(view) = &node.view else {
            for portal in portals.iter().filter(useful) {
                let (u, w) = (node.root.at.to(portal.right.at), node.root.at.to(portal.left.at));
                self.see(node.root, portal, u, w);
            }
            return;
        };
        let right_root = (view.right_at_end && entered.right.is_corner)
            .then(|| self.turn_at(&node.root, &entered.right))
            .flatten();
        let left_root = (view.left_at_end && entered.left.is_corner)
            .then(|| self.turn_at(&node.root, &entered.left))
            .flatten();
        for portal in portals.iter().filter(useful) {
            self.look_through(node, view, portal, (right_root, left_root));
        }
    }

    /// What of `portal` is seen in `view`, and what round the corners at its ends.
    fn look_through(
        &mut self,
        node: &Node,
        view: &View,
        portal: &Portal,
        (right_root, left_root): (Option<Root>, Option<Root>),
    ) {
        let root = node.root;
        let (u, w) = (root.at.to(portal.right.at), root.at.to(portal.left.at));
        let (right_u, right_w) = (cross(view.right, u), cross(view.right, w));
        let (left_u, left_w) = (cross(view.left, u), cross(view.left, w));
        if right_w > 0 && left_u < 0 {
            let seen = View {
                right: if right_u > 0 { u } else { view.right },
                left: if left_w < 0 { w } else { view.left },
                right_at_end: right_u >= 0,
                left_at_end: left_w <= 0,
            };
            self.made.push(Node { root, portal: *portal, view: Some(seen) });
        } else if (right_u == 0 && right_w == 0) || (left_u == 0 && left_w == 0) {
            self.see(root, portal, u, w);
        }
        if let Some(corner) = right_root {
            let same_end = portal.right.vertex == node.portal.right.vertex;
            if right_u < 0 || (same_end && right_w < 0) {
                let (u, w) = (corner.at.to(portal.right.at), corner.at.to(portal.left.at));
                self.see_between(
                    corner,
                    portal,
                    (u, w),
                    (u, if right_w <= 0 { w } else { view.right }),
                );
            }
        }
        if let Some(corner) = left_root {
            let same_end = portal.left.vertex == node.portal.left.vertex;
            if left_w > 0 || (same_end && left_u > 0) {
                let (u, w) = (corner.at.to(portal.right.at), corner.at.to(portal.left.at));
                self.see_between(
                    corner,
                    portal,
                    (u, w),
                    (if left_u >= 0 { u } else { view.left }, w),
                );
            }
        }
    }

    /// Adds the whole `portal` as seen from `root`, with its ends at `u` and `w` from there.
    fn see(&mut self, root: Root, portal: &Portal, u: Ray, w: Ray) {
        self.see_between(root, portal, (u, w), (u, w));
    }

    /// Adds what is seen of `portal`, with its ends at `u` and `w`, between the rays `right` and `left`.
    fn see_between(
        &mut self,
        root: Root,
        portal: &Portal,
        (u, w): (Ray, Ray),
        (right, left): (Ray, Ray),
    ) {
        if cross(u, w) != 0 {
            let (right_at_end, left_at_end) = (cross(right, u) == 0, cross(left, w) == 0);
            let view = Some(View { right, left, right_at_end, left_at_end });
            self.made.push(Node { root, portal: *portal, view });
            return;
        }
        // In line with the portal: the way goes along it to its nearer end and turns there.
        let square = |ray: Ray| ray.0 * ray.0 + ray.1 * ray.1;
        let end = if square(u) <= square(w) { &portal.right } else { &portal.left };
        if end.at == root.at {
            self.made.push(Node { root, portal: *portal, view: None });
        } else if let Some(root) = end.is_corner.then(|| self.turn_at(&root, end)).flatten() {
            self.made.push(Node { root, portal: *portal, view: None });
        }
    }

    /// The corner at `end` as the next root, unless a shorter way to it is known.
    fn turn_at(&mut self, root: &Root, end: &PortalEnd) -> Option<Root> {
        let length = root.length + root.at.distance(end.at);
        let known = &mut self.reached[end.vertex as usize];
        if known.query != self.query || length < known.length {
            *known = Reached { length, parent: root.vertex, at: end.at, query: self.query };
        } else if length > known.length * (1.0 + EQUAL) {
            return None;
        }
        Some(Root { at: end.at, vertex: end.vertex, length })
    }

    /// Whether a shorter way to `root` was found since the node was made.
    fn is_outdone(&self, root: &Root) -> bool {
        root.vertex != START
            && root.length > self.reached[root.vertex as usize].length * (1.0 + EQUAL)
    }

    /// Ends the way at `goal`, which lies in the piece that `node` enters.
    fn arrive(&mut self, node: &Node, goal: LatticePoint, best: &mut Best) {
        let ray = node.root.at.to(goal);
        let root = match &node.view {
            Some(view) if cross(view.right, ray) < 0 => {
                let end = &node.portal.right;
                (view.right_at_end && end.is_corner)
                    .then(|| self.turn_at(&node.root, end))
                    .flatten()
            }
            Some(view) if cross(view.left, ray) > 0 => {
                let end = &node.portal.left;
                (view.left_at_end && end.is_corner).then(|| self.turn_at(&node.root, end)).flatten()
            }
            _ => Some(node.root),
        };
        if let Some(root) = root {
            let length = root.length + root.at.distance(goal);
            if length < best.length {
                *best = Best { length, root: root.vertex };
            }
        }
    }

    /// Puts the nodes made last into the queue, those that cannot beat `best` left out.
    fn enqueue(&mut self, query: &Query, best: f64) {
        for node in &self.made {
            let cost = node.root.length + least_length(node, query.goal);
            if cost < best {
                self.queue.push(Ranked { cost, index: self.nodes.len() });
                self.nodes.push(*node);
            }
        }
    }

    /// The way back from the goal over `root` to the start, without points that lie on a straight line.
    fn trace(&self, query: &Query, mut root: u32) -> Vec<LatticePoint> {
        let mut points = vec![query.goal];
        while root != START {
            let reached = &self.reached[root as usize];
            points.push(reached.at);
            root = reached.parent;
        }
        points.push(query.start);
        points.reverse();
        straighten(&mut points);
        points
    }
}

/// Drops points at which the way does not turn.
fn straighten(points: &mut Vec<LatticePoint>) {
    let mut kept: Vec<LatticePoint> = Vec::with_capacity(points.len());
    for &point in points.iter() {
        while let [.., before, last] = kept[..] {
            let (u, w) = (before.to(last), last.to(point));
            if last != point && (cross(u, w) != 0 || u.0 * w.0 + u.1 * w.1 < 0) {
                break;
            }
            kept.pop();
        }
        kept.push(point);
    }
    *points = kept;
}

/// The least length from the root through what the node sees to `goal`: a lower bound of the rest.
fn least_length(node: &Node, goal: LatticePoint) -> f64 {
    let float = |ray: Ray| (ray.0 as f64, ray.1 as f64);
    let root = node.root.at;
    let target = float(root.to(goal));
    let Some(view) = &node.view else { return target.0.hypot(target.1) };
    let (u, w) = (float(root.to(node.portal.right.at)), float(root.to(node.portal.left.at)));
    let along = (w.0 - u.0, w.1 - u.1);
    let area = along.0 * u.1 - along.1 * u.0;
    let side = along.0 * (target.1 - u.1) - along.1 * (target.0 - u.0);
    // `area` and `side` are seen from the portal's line: the root lies at −area, the goal at side.
    let target = if side * area > 0.0 {
        target
    } else {
        // On the root's own side of the portal the goal is as far as its mirror image.
        let scale = 2.0 * side / (along.0 * along.0 + along.1 * along.1);
        (target.0 + scale * along.1, target.1 - scale * along.0)
    };
    let meet = |ray: Ray| {
        let (x, y) = float(ray);
        let scale = area / (along.0 * y - along.1 * x);
        (x * scale, y * scale)
    };
    let beyond = |ray: Ray| {
        let (x, y) = float(ray);
        x * target.1 - y * target.0
    };
    let by_way_of = |(x, y): (f64, f64)| {
        (x * x + y * y).sqrt() + ((target.0 - x).powi(2) + (target.1 - y).powi(2)).sqrt()
    };
    if beyond(view.right) < 0.0 {
        by_way_of(if view.right_at_end { u } else { meet(view.right) })
    } else if beyond(view.left) > 0.0 {
        by_way_of(if view.left_at_end { w } else { meet(view.left) })
    } else {
        (target.0 * target.0 + target.1 * target.1).sqrt()
    }
}
