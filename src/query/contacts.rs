//! What a line does at edges, at vertices and in planes: contacts that hang together are one event.
//!
//! Contacts hang together if they are at the same edge or vertex, not behind the origin, or if the line runs from one to
//! the other in the plane of a triangle. The passings of the moved line at all contacts of an event add up to what the event changes: how far
//! the line is inside before and after it. Zero is a touch.

use super::cast::{Cast, Contact, Key, Part, Touched};
use crate::topology::UnionFind;

/// A crossing or a touch, still in the tree's terms.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    pub(crate) triangle: u32,
    pub(crate) t: f64,
    pub(crate) weights: [f64; 3],
    pub(crate) part: Part,
    /// 1 leaving, -1 entering, 0 touching.
    pub(crate) crossing: i8,
}

/// The events at contacts, those at `t < 0` left out. O(n log n) in the contacts.
pub(crate) fn events(cast: &Cast<'_>, contacts: &[Contact], into: &mut Vec<Event>) {
    let mut places: Vec<(Key, u32, &Touched)> = contacts
        .iter()
        .enumerate()
        .flat_map(|(i, c)| c.at.iter().map(move |touched| (touched.key, i as u32, touched)))
        .collect();
    places.sort_by_key(|p| (p.0, p.1));
    // One group for each contact, joined where they share a key. What is behind the origin joins nothing: much of it has
    // not been looked at.
    let mut groups = UnionFind::new(contacts.len());
    for pair in places.windows(2).filter(|pair| pair[0].0 == pair[1].0 && pair[0].2.t >= 0.0) {
        groups.join(pair[0].1, pair[1].1);
    }
    let mut members: Vec<(u32, Key, u32, &Touched)> =
        places.iter().map(|&(key, contact, touched)| (groups.root(contact), key, contact, touched)).collect();
    members.sort_by_key(|m| (m.0, m.1, m.2));
    for event in members.chunk_by(|a, b| a.0 == b.0) {
        let last = event.iter().map(|m| m.3.t).fold(f64::NEG_INFINITY, f64::max);
        if last < 0.0 {
            continue;
        }
        let begin = event.iter().map(|m| m.3.t).fold(f64::INFINITY, f64::min);
        let mut own: Vec<u32> = event.iter().map(|m| m.2).collect();
        own.sort_unstable();
        own.dedup();
        let sum: i32 = own.iter().map(|&i| i32::from(contacts[i as usize].passes)).sum();
        // An origin within the contact is on the surface, where nothing is crossed; nor is anything at a rim.
        let sum = if begin < 0.0 || has_rim(cast, contacts, event) { 0 } else { sum };
        // Where the event begins, or the origin within it; of the faces there one that looks the way of the crossing, then
        // the first.
        let looks = |i: u32| {
            let contact = &contacts[i as usize];
            (i32::from(contact.facing) != sum.signum(), cast.tree().face(contact.triangle), contact.triangle)
        };
        let ahead =
            event.iter().filter(|m| m.3.t >= 0.0).map(|m| (m.3.t, m.1, looks(m.2), weights(m.3), m.3.part));
        let within = own.iter().filter_map(|&i| {
            let (weights, part) = at_origin(&contacts[i as usize])?;
            Some((0.0, (u32::MAX, u32::MAX, 0), looks(i), weights, part))
        });
        let first =
            ahead.chain(within).min_by(|a, b| a.0.total_cmp(&b.0).then_with(|| (a.1, a.2).cmp(&(b.1, b.2))));
        let Some((t, _, (_, _, triangle), weights, part)) = first else { continue };
        let event = Event { triangle, t, weights, part, crossing: sum.signum() as i8 };
        // A surface that winds about a vertex several times is crossed as often.
        into.extend(std::iter::repeat_n(event, sum.unsigned_abs().max(1) as usize));
    }
}

fn weights(touched: &Touched) -> [f64; 3] {
    let mut weights = [0.0; 3];
    match touched.part {
        Part::Corner(i) => weights[i] = 1.0,
        Part::Edge(i) => (weights[i], weights[(i + 1) % 3]) = (1.0 - touched.along, touched.along),
        Part::Inside => {}
    }
    weights
}

/// Where the line's origin is in a triangle, if it is between two of the triangle's contacts.
fn at_origin(contact: &Contact) -> Option<([f64; 3], Part)> {
    let before = contact.at.iter().find(|touched| touched.t < 0.0)?;
    let after = contact.at.iter().find(|touched| touched.t > 0.0)?;
    let share = before.t / (before.t - after.t);
    let (a, b) = (weights(before), weights(after));
    let part = match (before.part, after.part) {
        (Part::Corner(i), Part::Corner(j)) => Part::Edge(if (i + 1) % 3 == j { i } else { j }),
        _ => Part::Inside,
    };
    Some(([0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * share), part))
}

/// Whether an edge or a vertex of an event lies on the surface's boundary. All triangles there are among the contacts.
fn has_rim(cast: &Cast<'_>, contacts: &[Contact], event: &[(u32, Key, u32, &Touched)]) -> bool {
    event.chunk_by(|a, b| a.1 == b.1).any(|at| {
        let (low, high, cut) = at[0].1;
        if low != high {
            return cut == 0 && at.len() == 1;
        }
        // The far ends of the edges at the vertex: two triangles at each.
        let around = at.iter().map(|m| cast.tree().corners(contacts[m.2 as usize].triangle));
        let mut ends: Vec<u32> = around.flatten().filter(|&v| v != low).collect();
        ends.sort_unstable();
        ends.chunk_by(|a, b| a == b).any(|end| end.len() == 1)
    })
}
