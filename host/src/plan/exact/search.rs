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
use super::view::{Ray, Sides, View, cross, dot, least_length, ray};
use crate::grid::LatticePoint;
use std::collections::BinaryHeap;

/// The number of the start among the roots, where corners have their own numbers.
const START: u32 = u32::MAX;

/// Two ways to one corner whose lengths differ by less than this part are equally good.
const EQUAL: f64 = 1e-12;

/// Where a cone begins: the start or a corner at which the way turned.
#[derive(Clone, Copy, Debug)]
struct Root {
    at: LatticePoint,
    /// The number of the corner, or [`START`].
    corner: u32,
    /// The length of the way up to here.
    length: f64,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    root: Root,
    /// The number of the portal.
    portal: u32,
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
pub(in crate::plan) struct Search {
    reached: Vec<Reached>,
    query: u32,
    nodes: Vec<Node>,
    queue: BinaryHeap<Ranked>,
    /// Whether the query's way enters no dead end.
    avoids_dead_ends: bool,
    /// The nodes that one expansion makes.
    made: Vec<Node>,
}

/// The ends of a query and the pieces that hold them, edges included.
#[derive(Clone, Copy, Debug)]
pub(in crate::plan) struct Query<'a> {
    pub(in crate::plan) start: LatticePoint,
    pub(in crate::plan) goal: LatticePoint,
    pub(in crate::plan) start_pieces: &'a [u32],
    pub(in crate::plan) goal_pieces: &'a [u32],
}

impl Query<'_> {
    /// Whether the way neither begins nor ends in a dead end, so that it enters none.
    fn avoids_dead_ends(&self, mesh: &Mesh) -> bool {
        let mut ends = self.start_pieces.iter().chain(self.goal_pieces);
        !ends.any(|&piece| mesh.is_dead_end(piece))
    }
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
    pub(in crate::plan) fn shortest(
        &mut self,
        mesh: &Mesh,
        query: &Query,
    ) -> Option<Vec<LatticePoint>> {
        if query.start_pieces.iter().any(|piece| query.goal_pieces.contains(piece)) {
            return Some(vec![query.start, query.goal]);
        }
        self.prepare(mesh);
        self.avoids_dead_ends = query.avoids_dead_ends(mesh);
        let mut best = Best { length: f64::INFINITY, root: START };
        self.leave_start(mesh, query);
        self.enqueue(mesh, query, best.length);
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
                let portal = mesh.portal(node.portal as usize);
                if query.goal_pieces.contains(&portal.beyond) {
                    self.arrive(&node, portal, query.goal, &mut best);
                }
                self.expand(mesh, &node);
                match self.made[..] {
                    [only] => node = only,
                    _ => break self.enqueue(mesh, query, best.length),
                }
            }
        }
        best.length.is_finite().then(|| self.trace(query, best.root))
    }

    fn prepare(&mut self, mesh: &Mesh) {
        self.query = self.query.wrapping_add(1);
        if self.reached.len() < mesh.corners || self.query == 0 {
            let unreached =
                Reached { length: 0.0, parent: START, at: LatticePoint::new(0, 0), query: 0 };
            self.reached = vec![unreached; mesh.corners];
            self.query = 1;
        }
        self.nodes.clear();
        self.queue.clear();
        self.made.clear();
    }

    /// The views out of the pieces that hold the start.
    fn leave_start(&mut self, mesh: &Mesh, query: &Query) {
        let start = Root { at: query.start, corner: START, length: 0.0 };
        for number in query.start_pieces.iter().flat_map(|&piece| mesh.range(piece)) {
            let portal = mesh.portal(number);
            // Through a portal that the start lies on, the next piece holds the start too.
            if !query.start_pieces.contains(&portal.beyond) {
                self.see(start, portal, number);
            }
        }
    }

    /// Adds the nodes behind the portals of the piece that `node` enters.
    fn expand(&mut self, mesh: &Mesh, node: &Node) {
        let entered = mesh.portal(node.portal as usize);
        let view = node.view.as_ref();
        let right = view.filter(|view| view.right_at_end);
        let right = right.and_then(|_| self.turn_at(&node.root, &entered.right));
        let left = view.filter(|view| view.left_at_end);
        let left = left.and_then(|_| self.turn_at(&node.root, &entered.left));
        for number in mesh.range(entered.beyond) {
            let portal = mesh.portal(number);
            if portal.is_back_of(entered) || (self.avoids_dead_ends && portal.is_dead_end) {
                continue;
            }
            let Some(view) = view else {
                self.see(node.root, portal, number);
                continue;
            };
            let sides = Sides::of(node.root.at, view, portal);
            self.look_through(&node.root, view, &sides, (portal, number));
            if let Some(corner) = right {
                self.look_right(corner, view, &sides, (portal, number));
            }
            if let Some(corner) = left {
                self.look_left(corner, view, &sides, (portal, number));
            }
        }
    }

    /// Adds what of `portal` is seen only when the way turns right at `corner`.
    fn look_right(&mut self, corner: Root, view: &View, sides: &Sides, portal: (&Portal, usize)) {
        let (right, left) = (portal.0.right.at, portal.0.left.at);
        if sides.right_of_right(right == corner.at) {
            let is_whole = sides.left_end.0 <= 0;
            let bound = if is_whole { ray(corner.at, left) } else { view.right };
            self.see_between(corner, portal, (ray(corner.at, right), bound));
        }
    }

    /// Adds what of `portal` is seen only when the way turns left at `corner`.
    fn look_left(&mut self, corner: Root, view: &View, sides: &Sides, portal: (&Portal, usize)) {
        let (right, left) = (portal.0.right.at, portal.0.left.at);
        if sides.left_of_left(left == corner.at) {
            let is_whole = sides.right_end.1 >= 0;
            let bound = if is_whole { ray(corner.at, right) } else { view.left };
            self.see_between(corner, portal, (bound, ray(corner.at, left)));
        }
    }

    /// Adds what of `portal` lies between the rays of `view`.
    fn look_through(
        &mut self,
        root: &Root,
        view: &View,
        sides: &Sides,
        (portal, number): (&Portal, usize),
    ) {
        if let Some(seen) = sides.narrow(root.at, view, portal) {
            self.made.push(Node { root: *root, portal: number as u32, view: Some(seen) });
        } else if sides.is_in_line() {
            self.see(*root, portal, number);
        }
    }

    /// Adds the whole `portal` as seen from `root`.
    fn see(&mut self, root: Root, portal: &Portal, number: usize) {
        let rays = (ray(root.at, portal.right.at), ray(root.at, portal.left.at));
        self.see_between(root, (portal, number), rays);
    }

    /// Adds what is seen of `portal` between the rays `right` and `left`.
    fn see_between(
        &mut self,
        root: Root,
        (portal, number): (&Portal, usize),
        (right, left): (Ray, Ray),
    ) {
        let (u, w) = (ray(root.at, portal.right.at), ray(root.at, portal.left.at));
        let portal_number = number as u32;
        if cross(u, w) != 0 {
            let (right_at_end, left_at_end) = (cross(right, u) == 0, cross(left, w) == 0);
            let view = Some(View { right, left, right_at_end, left_at_end });
            self.made.push(Node { root, portal: portal_number, view });
            return;
        }
        if dot(u, w) < 0 {
            // On the portal: what lies beyond is in view.
            self.made.push(Node { root, portal: portal_number, view: None });
            return;
        }
        // In line with the portal: the way goes along it to its nearer end and turns there.
        let end = if dot(u, u) <= dot(w, w) { &portal.right } else { &portal.left };
        if end.at == root.at {
            self.made.push(Node { root, portal: portal_number, view: None });
        } else if let Some(root) = self.turn_at(&root, end) {
            self.made.push(Node { root, portal: portal_number, view: None });
        }
    }

    /// The corner at `end` as the next root, unless there is none or a shorter way to it is known.
    fn turn_at(&mut self, root: &Root, end: &PortalEnd) -> Option<Root> {
        if !end.has_corner() {
            return None;
        }
        let length = root.length + root.at.distance(end.at);
        let known = &mut self.reached[end.corner as usize];
        if known.query != self.query || length < known.length {
            *known = Reached { length, parent: root.corner, at: end.at, query: self.query };
        } else if length > known.length * (1.0 + EQUAL) {
            return None;
        }
        Some(Root { at: end.at, corner: end.corner, length })
    }

    /// Whether a shorter way to `root` was found since the node was made.
    fn is_outdone(&self, root: &Root) -> bool {
        root.corner != START
            && root.length > self.reached[root.corner as usize].length * (1.0 + EQUAL)
    }

    /// Ends the way at `goal`, which lies in the piece behind `portal` that `node` enters.
    fn arrive(&mut self, node: &Node, portal: &Portal, goal: LatticePoint, best: &mut Best) {
        let towards = ray(node.root.at, goal);
        let root = match &node.view {
            Some(view) if cross(view.right, towards) < 0 => {
                view.right_at_end.then(|| self.turn_at(&node.root, &portal.right)).flatten()
            }
            Some(view) if cross(view.left, towards) > 0 => {
                view.left_at_end.then(|| self.turn_at(&node.root, &portal.left)).flatten()
            }
            _ => Some(node.root),
        };
        if let Some(root) = root {
            let length = root.length + root.at.distance(goal);
            if length < best.length {
                *best = Best { length, root: root.corner };
            }
        }
    }

    /// Puts the nodes made last into the queue, those that cannot beat `best` left out.
    fn enqueue(&mut self, mesh: &Mesh, query: &Query, best: f64) {
        for node in &self.made {
            let cost = node.root.length + {
                let portal = mesh.portal(node.portal as usize);
                least_length(node.root.at, node.view.as_ref(), portal, query.goal)
            };
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
pub(super) fn straighten(points: &mut Vec<LatticePoint>) {
    let mut kept = 0;
    for index in 0..points.len() {
        let point = points[index];
        while kept > 1 {
            let (before, last) = (points[kept - 2], points[kept - 1]);
            let (u, w) = (ray(before, last), ray(last, point));
            if last != point && (cross(u, w) != 0 || dot(u, w) < 0) {
                break;
            }
            kept -= 1;
        }
        points[kept] = point;
        kept += 1;
    }
    points.truncate(kept);
}
