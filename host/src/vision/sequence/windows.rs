//! Windows of the floor that are to be read again: around what has changed, whole things at a time.

use crate::geometry::Rect;

/// How far a window reaches beyond what it holds, metres: what is beside a thing tells that it is one.
const RIM: f64 = 0.05;

/// The windows around some places, such that each of `things` lies in one as a whole or in none; no two overlap.
pub(super) fn around(places: &[Rect], things: &[Rect]) -> Vec<Rect> {
    let mut windows: Vec<Rect> = places.iter().map(|place| place.widened([RIM; 4])).collect();
    loop {
        let before = windows.clone();
        for window in &mut windows {
            for thing in things {
                if thing.overlaps(*window) {
                    *window = window.union(thing.widened([RIM; 4]));
                }
            }
        }
        windows = merged(windows);
        if windows == before {
            return windows;
        }
    }
}

/// The same with those that overlap made one.
fn merged(windows: Vec<Rect>) -> Vec<Rect> {
    let mut apart: Vec<Rect> = Vec::with_capacity(windows.len());
    for mut window in windows {
        while let Some(index) = apart.iter().position(|other| other.overlaps(window)) {
            window = window.union(apart.swap_remove(index));
        }
        apart.push(window);
    }
    apart
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thing_that_a_window_touches_lies_in_it_as_a_whole_and_what_that_touches_too() {
        let row: Vec<Rect> =
            (0..4).map(|i| f64::from(i) * 0.3).map(|x| Rect::new(x, 0.0, x + 0.27, 0.2)).collect();
        let place = Rect::new(0.1, 0.21, 0.12, 0.23);
        let [window] = around(&[place], &row[..2])[..] else { panic!() };
        assert!((window.x0 + RIM).abs() < 1e-12 && (window.x1 - 0.57 - RIM).abs() < 1e-12);
        assert!((window.y0 + RIM).abs() < 1e-12 && (window.y1 - 0.23 - RIM).abs() < 1e-12);
        let far = Rect::new(3.0, 3.0, 3.1, 3.1);
        let all = around(&[place, far], &row);
        assert_eq!(all.len(), 2);
        assert!(row.iter().all(|thing| all.iter().any(|w| w.union(*thing) == *w)), "{all:?}");
    }

    #[test]
    fn windows_that_overlap_are_one() {
        let places = [0.0, 0.14, 0.07].map(|x| Rect::new(x, 0.0, x + 0.01, 0.01));
        assert_eq!(around(&places, &[]).len(), 1);
    }
}
