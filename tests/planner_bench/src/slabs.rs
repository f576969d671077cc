//! The free floor cut into rectangles by vertical lines, as a mesh for `polyanya`: of its three recipes
//! the one that is built quickest. A sweep of its own, so that the peer owes nothing to the planner.

use wmr::geometry::Rect;
use polyanya::{Mesh, Polygon, Vertex};

/// The mesh of what `boxes` leave of `inside`; metres with the planner's resolution of 0.1 mm.
pub fn mesh(inside: &Rect, boxes: &[Rect]) -> Option<Mesh> {
    let cells = cells(lattice(inside), &boxes.iter().map(lattice).collect::<Vec<_>>());
    let mut points: Vec<(i64, i64)> = cells
        .iter()
        .flat_map(|c| [(c[0], c[1]), (c[2], c[1]), (c[2], c[3]), (c[0], c[3])])
        .collect();
    points.sort_unstable();
    points.dedup();
    let number = |point: (i64, i64)| points.partition_point(|&other| other < point);
    // By point: the cell in each quadrant around it, counter-clockwise from the upper right.
    let mut around = vec![[u32::MAX; 4]; points.len()];
    let mut polygons = Vec::with_capacity(cells.len());
    for (index, &[x0, y0, x1, y1]) in cells.iter().enumerate() {
        let (left, right) =
            (number((x0, y0))..=number((x0, y1)), number((x1, y0))..=number((x1, y1)));
        for place in left.clone() {
            set(&mut around[place], [points[place].1 < y1, points[place].1 > y0], [0, 3], index);
        }
        for place in right.clone() {
            set(&mut around[place], [points[place].1 < y1, points[place].1 > y0], [1, 2], index);
        }
        let ring = right.chain(left.rev()).map(|place| place as u32);
        // From the lower right upwards, then from the upper left downwards.
        polygons.push(Polygon::new(ring.collect(), false));
    }
    let vertices = points.iter().zip(&around).map(|(&(x, y), cells)| {
        let mut ring = cells.to_vec();
        ring.dedup();
        if ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        Vertex::new(glam::vec2(x as f32 / 10_000.0, y as f32 / 10_000.0), ring)
    });
    let mut mesh = Mesh::new(vertices.collect(), polygons).ok()?;
    mesh.bake();
    Some(mesh)
}

fn set(around: &mut [u32; 4], is_there: [bool; 2], quadrants: [usize; 2], cell: usize) {
    for (quadrant, _) in quadrants.into_iter().zip(is_there).filter(|(_, is_there)| *is_there) {
        around[quadrant] = cell as u32;
    }
}

fn lattice(rect: &Rect) -> [i64; 4] {
    [rect.x0, rect.y0, rect.x1, rect.y1].map(|metres| (metres * 10_000.0).round() as i64)
}

/// The rectangles of the free floor, `[x0, y0, x1, y1]`.
fn cells(inside: [i64; 4], boxes: &[[i64; 4]]) -> Vec<[i64; 4]> {
    let mut events: Vec<(i64, bool, usize)> = Vec::with_capacity(2 * boxes.len());
    for (index, rect) in boxes.iter().enumerate() {
        events.extend([(rect[0], true, index), (rect[2], false, index)]);
    }
    events.sort_unstable();
    let mut active: Vec<(i64, i64, usize)> = Vec::new();
    let mut open: Vec<[i64; 4]> = vec![[inside[0], inside[1], 0, inside[3]]];
    let mut done = Vec::with_capacity(3 * boxes.len() + 1);
    for group in events.chunk_by(|a, b| a.0 == b.0) {
        let x = group[0].0;
        for &(_, begins, index) in group {
            let key = (boxes[index][1], boxes[index][3], index);
            match (active.binary_search(&key), begins) {
                (Err(place), true) => active.insert(place, key),
                (Ok(place), false) => drop(active.remove(place)),
                _ => {}
            }
        }
        let mut free = Vec::with_capacity(open.len() + 2);
        let mut low = inside[1];
        for &(y0, y1, _) in active.iter().chain([&(inside[3], inside[3], 0)]) {
            if y0 > low {
                free.push((low, y0));
            }
            low = low.max(y1);
        }
        let mut next = Vec::with_capacity(free.len());
        let mut old = open.iter().peekable();
        for &(y0, y1) in free.iter().filter(|_| x < inside[2]) {
            while let Some(cell) = old.next_if(|cell| (cell[1], cell[3]) < (y0, y1)) {
                done.push([cell[0], cell[1], x, cell[3]]);
            }
            match old.next_if(|cell| (cell[1], cell[3]) == (y0, y1)) {
                Some(cell) => next.push(*cell),
                None => next.push([x, y0, 0, y1]),
            }
        }
        done.extend(old.map(|cell| [cell[0], cell[1], x, cell[3]]));
        open = next;
    }
    done.extend(open.into_iter().map(|cell| [cell[0], cell[1], inside[2], cell[3]]));
    done.retain(|cell| cell[0] < cell[2]);
    done
}
