//! What can be seen from a point without turning: the corners in sight, and the goal.
//!
//! The cones are those of the search, on the same pieces and with the same signs; here nothing turns
//! at a corner, so that what is found depends on the point alone and can be kept. Lattice units.

use super::mesh::{Mesh, Portal, PortalEnd};
use super::view::{Ray, Sides, View, cross, dot, ray};
use crate::grid::LatticePoint;

/// Where one looks from, and which directions are of interest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outlook<'a> {
    pub(super) from: LatticePoint,
    /// The pieces that hold the point, edges included.
    pub(super) pieces: &'a [u32],
    /// The signs of x and y of a quadrant in which nothing is of interest.
    pub(super) but: Option<(i32, i32)>,
}

impl Outlook<'_> {
    fn is_of_no_interest(&self, view: &View) -> bool {
        let is_inside =
            |(x, y): (i32, i32), ray: Ray| ray.0.signum() * x > 0 && ray.1.signum() * y > 0;
        self.but.is_some_and(|quadrant| {
            is_inside(quadrant, view.right) && is_inside(quadrant, view.left)
        })
    }
}

/// A portal with what is seen through it.
#[derive(Clone, Copy, Debug)]
struct Cone {
    portal: u32,
    view: View,
}

/// Looks around; keeps its memory from one look to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Sight {
    cones: Vec<Cone>,
    /// The ends of portals in sight at which a corner stands; some more than once.
    pub(super) corners: Vec<PortalEnd>,
}

impl Sight {
    /// Finds the corners that are in sight; of corners on one ray at least the nearest. Returns
    /// whether `target`, a point with the pieces that hold it, is in sight too.
    pub(super) fn look(
        &mut self,
        mesh: &Mesh,
        outlook: &Outlook,
        target: Option<(LatticePoint, &[u32])>,
    ) -> bool {
        self.cones.clear();
        self.corners.clear();
        for number in outlook.pieces.iter().flat_map(|&piece| mesh.range(piece)) {
            let portal = mesh.portal(number);
            if outlook.pieces.contains(&portal.beyond) {
                // The point lies on this portal, and looks out of the piece behind it as well.
                self.note(&portal.right, portal.right.at != outlook.from);
                self.note(&portal.left, portal.left.at != outlook.from);
            } else {
                self.see_whole(outlook, portal, number);
            }
        }
        while let Some(cone) = self.cones.pop() {
            let entered = mesh.portal(cone.portal as usize);
            self.note(&entered.right, cone.view.right_at_end);
            self.note(&entered.left, cone.view.left_at_end);
            if target.is_some_and(|(target, pieces)| {
                pieces.contains(&entered.beyond) && shows(&cone.view, ray(outlook.from, target))
            }) {
                return true;
            }
            self.go_on(mesh, outlook, &cone, entered);
        }
        false
    }

    fn note(&mut self, end: &PortalEnd, is_seen: bool) {
        if is_seen && end.has_corner() {
            self.corners.push(*end);
        }
    }

    /// Adds what the cone shows of the portals of the piece that it enters.
    fn go_on(&mut self, mesh: &Mesh, outlook: &Outlook, cone: &Cone, entered: &Portal) {
        for number in mesh.range(entered.beyond) {
            let portal = mesh.portal(number);
            if portal.is_on_line_of(entered) {
                continue;
            }
            let sides = Sides::of(outlook.from, &cone.view, portal);
            if let Some(view) = sides.narrow(outlook.from, &cone.view, portal) {
                self.push(outlook, number, view);
            } else if sides.is_in_line() {
                self.see_whole(outlook, portal, number);
            }
        }
    }

    /// Adds the whole `portal`; of one in line with the point only the nearer end is seen.
    fn see_whole(&mut self, outlook: &Outlook, portal: &Portal, number: usize) {
        let (right, left) = (ray(outlook.from, portal.right.at), ray(outlook.from, portal.left.at));
        if cross(right, left) != 0 {
            let view = View { right, left, right_at_end: true, left_at_end: true };
            self.push(outlook, number, view);
        } else if dot(right, right) <= dot(left, left) {
            self.note(&portal.right, true);
        } else {
            self.note(&portal.left, true);
        }
    }

    fn push(&mut self, outlook: &Outlook, number: usize, view: View) {
        if !outlook.is_of_no_interest(&view) {
            self.cones.push(Cone { portal: number as u32, view });
        }
    }
}

fn shows(view: &View, towards: Ray) -> bool {
    cross(view.right, towards) >= 0 && cross(view.left, towards) <= 0
}
