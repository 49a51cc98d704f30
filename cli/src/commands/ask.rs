//! Commands that ask where the mesh lies: rays and nearest elements.

use super::in_file;
use super::look::fields;
use crate::args::{Closest, Raycast, Target};
use crate::import;
use crate::session::{Answer, Failure, Phase, Session};
use meshwright::glam::DVec3;
use meshwright::{
    ClosestOptions, Crossing, EdgeKey, Element, FaceKey, Feature, Maps, Mesh, MeshIndex, Nearest, Ray,
    RayHit, VertexKey,
};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Element numbers of the mesh in terms of the file.
struct Numbers<'a> {
    mesh: &'a Mesh,
    maps: &'a Maps,
    vertices: Vec<VertexKey>,
    faces: Vec<FaceKey>,
}

impl<'a> Numbers<'a> {
    fn new(mesh: &'a Mesh, maps: &'a Maps) -> Self {
        // Keys ascend in the order of elements.
        Self { mesh, maps, vertices: mesh.vertices().collect(), faces: mesh.faces().collect() }
    }

    fn vertex(&self, v: VertexKey) -> u32 {
        let at = self.vertices.binary_search(&v).unwrap_or_else(|at| at);
        in_file(&self.maps.vertices, at as u32)
    }

    fn face(&self, f: FaceKey) -> u32 {
        let at = self.faces.binary_search(&f).unwrap_or_else(|at| at);
        in_file(&self.maps.faces, at as u32)
    }

    fn edge(&self, e: EdgeKey) -> [u32; 2] {
        let h = self.mesh.edge_halfedge(e);
        let [a, b] = [self.mesh.origin(h), self.mesh.target(h)].map(|v| self.vertex(v));
        [a.min(b), a.max(b)]
    }

    fn feature(&self, feature: Feature) -> Element {
        match feature {
            Feature::Face(f) => Element::Face(self.face(f)),
            Feature::Edge(e) => Element::Edge(self.edge(e)),
            Feature::Vertex(v) => Element::Vertex(self.vertex(v)),
        }
    }
}

pub(super) fn raycast(session: &mut Session, args: &Raycast) -> Result<Answer, Failure> {
    let ray = |[x, y, z, u, v, w]: [f64; 6]| Ray::new(DVec3::new(x, y, z), DVec3::new(u, v, w));
    let rays: Vec<Ray> = match (&args.queries, &args.origin, &args.direction) {
        (Some(file), ..) => {
            let rows = rows(file)?;
            let checked =
                rows.into_iter().map(|(line, row)| ray(row).map_err(|e| refused_line(file, line, &e)));
            checked.collect::<Result<_, _>>()?
        }
        (None, Some(o), Some(d)) => {
            vec![Ray::new(DVec3::from(o.0), DVec3::from(d.0)).map_err(Failure::refused)?]
        }
        _ => return Err(Failure::Usage("--origin and --direction, or --queries".to_owned())),
    };
    let (mesh, maps, import) = import::mesh_with_maps(session, &args.file, args.strict.strict)?;
    let index = session.timed(Phase::Build, || mesh.index());
    let hits: Vec<Vec<RayHit>> = session.timed(Phase::Run, || {
        if args.first {
            index.first_hit_batch(&rays).into_iter().map(|hit| hit.into_iter().collect()).collect()
        } else {
            index.hits_batch(&rays)
        }
    });
    let numbers = Numbers::new(&mesh, &maps);
    let answers = hits.iter().map(|hits| {
        let all: Vec<Value> = hits.iter().map(|h| hit(&numbers, h)).collect();
        json!({ "hits": all })
    });
    let mut text = String::new();
    for hits in &hits {
        let _ = writeln!(text, "{} hits", hits.len());
        for h in hits {
            let what = match h.crossing {
                Crossing::Enter => "enters",
                Crossing::Leave => "leaves",
                Crossing::Touch => "touches",
            };
            let feature = numbers.feature(h.feature);
            let _ = writeln!(text, "t {}: {what} at {}, {feature}", h.t, h.point);
        }
    }
    Ok(answer(answers.collect(), args.queries.is_some(), import, text))
}

fn hit(numbers: &Numbers<'_>, h: &RayHit) -> Value {
    let entering = match h.crossing {
        Crossing::Enter => Some(true),
        Crossing::Leave => Some(false),
        Crossing::Touch => None,
    };
    json!({
        "t": h.t,
        "point": h.point,
        "face": numbers.face(h.face),
        "feature": numbers.feature(h.feature),
        "entering": entering,
        "touch": entering.is_none(),
    })
}

/// What is printed of a nearest element.
struct Found {
    point: DVec3,
    distance: f64,
    element: Element,
    more: Value,
}

pub(super) fn closest(session: &mut Session, args: &Closest) -> Result<Answer, Failure> {
    let points: Vec<DVec3> = match (&args.queries, &args.point) {
        (Some(file), _) => {
            let finite = |(line, [x, y, z]): (usize, [f64; 3])| {
                let p = DVec3::new(x, y, z);
                if p.is_finite() { Ok(p) } else { Err(refused_line(file, line, &"the point is not finite")) }
            };
            rows(file)?.into_iter().map(finite).collect::<Result<_, _>>()?
        }
        (None, Some(p)) => vec![DVec3::from(p.0)],
        _ => return Err(Failure::Usage("--point, or --queries".to_owned())),
    };
    let options = ClosestOptions {
        max_distance: args.max_distance.unwrap_or(f64::INFINITY),
        ..ClosestOptions::default()
    };
    if let Some(bad) = points.iter().find(|p| !p.is_finite()) {
        return Err(Failure::refused(format!("the point {bad} is not finite")));
    }
    let (mesh, maps, import) = import::mesh_with_maps(session, &args.file, args.strict.strict)?;
    let index = session.timed(Phase::Build, || mesh.index());
    let numbers = Numbers::new(&mesh, &maps);
    let found = session
        .timed(Phase::Run, || nearest(&index, &numbers, &points, args.to, options))
        .map_err(Failure::refused)?;
    let is_no = args.queries.is_none() && found.iter().all(Option::is_none);
    let mut text = String::new();
    for f in &found {
        let _ = match f {
            Some(f) => writeln!(text, "{} at {}, distance {}", f.element, f.point, f.distance),
            None => writeln!(text, "none"),
        };
    }
    let answers = found.into_iter().map(|found| match found {
        Some(f) => {
            let mut all = fields(json!({ "point": f.point, "distance": f.distance, "element": f.element }));
            all.append(&mut fields(f.more));
            Value::Object(all)
        }
        None => json!({ "point": null, "distance": null, "element": null }),
    });
    let mut answer = answer(answers.collect(), args.queries.is_some(), import, text);
    answer.is_no = is_no;
    Ok(answer)
}

fn nearest(
    index: &MeshIndex<'_>,
    numbers: &Numbers<'_>,
    points: &[DVec3],
    to: Target,
    options: ClosestOptions,
) -> Result<Vec<Option<Found>>, meshwright::QueryError> {
    fn all<K>(found: Vec<Option<Nearest<K>>>, element: impl Fn(K) -> Element) -> Vec<Option<Found>> {
        let one = |n: Nearest<K>| Found {
            point: n.point,
            distance: n.distance,
            element: element(n.element),
            more: Value::Null,
        };
        found.into_iter().map(|n| n.map(one)).collect()
    }
    let face = |f| Element::Face(numbers.face(f));
    Ok(match to {
        Target::Vertex => {
            all(index.closest_vertex_batch(points, options)?, |v| Element::Vertex(numbers.vertex(v)))
        }
        Target::Edge => all(index.closest_edge_batch(points, options)?, |e| Element::Edge(numbers.edge(e))),
        Target::Face => all(index.closest_face_batch(points, options)?, face),
        Target::FaceCenter => all(index.closest_face_center_batch(points, options)?, face),
        Target::Surface => {
            let found = index.closest_point_batch(points, options)?.into_iter();
            let one = |n: meshwright::ClosestPoint| Found {
                point: n.point,
                distance: n.distance,
                element: numbers.feature(n.feature),
                more: json!({ "face": numbers.face(n.face), "signed_distance": n.signed_distance() }),
            };
            found.map(|n| n.map(one)).collect()
        }
    })
}

/// One answer as it is, or several in `results`.
fn answer(answers: Vec<Value>, is_batch: bool, import: Value, text: String) -> Answer {
    let mut json = if is_batch {
        fields(json!({ "results": answers }))
    } else {
        answers.into_iter().next().map(fields).unwrap_or_default()
    };
    json.insert("import".to_owned(), import);
    Answer { json, text, ..Answer::default() }
}

/// The numbers of a file of questions, `N` a line, with the number of the line. Blank lines are skipped.
fn rows<const N: usize>(path: &Path) -> Result<Vec<(usize, [f64; N])>, Failure> {
    let input =
        |message: String, place| Failure::Input { message: format!("{}: {message}", path.display()), place };
    let text = std::fs::read_to_string(path).map_err(|e| input(e.to_string(), None))?;
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(i, line)| {
            let numbers: Result<Vec<f64>, _> = line.split(',').map(|n| n.trim().parse()).collect();
            let row = numbers.ok().and_then(|n| <[f64; N]>::try_from(n).ok());
            let message = || format!("line {} is not {N} numbers separated by commas", i + 1);
            row.map(|row| (i + 1, row))
                .ok_or_else(|| input(message(), Some(meshwright::io::Place::Line(i as u64 + 1))))
        })
        .collect()
}

fn refused_line(path: &Path, line: usize, error: &impl std::fmt::Display) -> Failure {
    Failure::refused(format!("{}: line {line}: {error}", path.display()))
}
