//! Columns themselves: keys, removal, clones, the way out and back.

use crate::shapes::{grid, icosphere, mesh};
use crate::{two_squares, with_x};
use meshwright::glam::DVec3;
use meshwright::{
    Column, ColumnError, ColumnValues, EdgeKey, FaceKey, HalfedgeKey, Mesh, NormalWeight, Rule, VertexKey,
};

#[test]
fn a_boundary_half_edge_has_no_corner() {
    let mut mesh = two_squares();
    let column = mesh.add_corner_column(5, Rule::keep());
    let outer = mesh.boundary_halfedges().next().expect("open");
    assert_eq!(mesh.set_value(column, outer, 1), Err(ColumnError::NoCorner(outer)));
    assert_eq!(*mesh.value(column, outer), 5);
    assert!(!mesh.is_seam(column, mesh.edge(outer)));
}

#[test]
fn a_removed_column_is_gone_and_its_place_is_not_taken() {
    let mut mesh = two_squares();
    let first = mesh.add_vertex_column(1, Rule::keep());
    let v = mesh.vertices().next().expect("six");
    assert!(mesh.remove_column(first));
    let second = mesh.add_vertex_column(2, Rule::keep());
    assert!(!mesh.remove_column(first) && !mesh.has_column(first) && mesh.has_column(second));
    assert_eq!(mesh.get_value(first, v), None);
    assert_eq!(mesh.set_value(first, v, 3), Err(ColumnError::NoColumn));
    assert_eq!(mesh.export_column(first), Err(ColumnError::NoColumn));
    let e = mesh.edges().next().expect("seven");
    mesh.split_edge(e, DVec3::ONE).expect("always");
    assert_eq!(*mesh.value(second, v), 2);
}

#[test]
#[should_panic(expected = "Column(0) names no live")]
fn reading_a_removed_column_panics() {
    let mut mesh = two_squares();
    let column = mesh.add_vertex_column(1, Rule::keep());
    let v = mesh.vertices().next().expect("six");
    mesh.remove_column(column);
    let _ = mesh.value(column, v);
}

#[test]
fn a_dead_key_has_no_value() {
    let mut mesh = two_squares();
    let column = mesh.add_face_column(1, Rule::keep());
    let f = mesh.faces().next().expect("two");
    mesh.remove_face(f).expect("an end");
    assert_eq!(mesh.get_value(column, f), None);
    assert_eq!(mesh.set_value(column, f, 2), Err(ColumnError::Missing));
}

#[test]
fn a_column_of_another_type_is_not_read_as_this_one() {
    let mut a = two_squares();
    let mut b = two_squares();
    let numbers = a.add_vertex_column(1u32, Rule::keep());
    b.add_vertex_column("one".to_owned(), Rule::keep());
    let v = b.vertices().next().expect("six");
    assert_eq!((b.get_value(numbers, v), b.has_column(numbers)), (None, false));
    assert_eq!(b.set_value(numbers, v, 7), Err(ColumnError::NoColumn));
    assert!(!b.remove_column(numbers));
}

#[test]
fn a_clone_has_columns_of_its_own() {
    let (mut mesh, x) = with_x(Rule::interpolate());
    let mut clone = mesh.clone();
    let v = mesh.vertices().next().expect("six");
    let before = *mesh.value(x, v);
    clone.set_value(x, v, 99.0).expect("live");
    assert_eq!(*mesh.value(x, v), before);
    mesh.remove_column(x);
    let e = clone.edges().next().expect("seven");
    let new = clone.split_edge(e, DVec3::ONE).expect("always");
    assert!(clone.get_value(x, new.vertex).is_some());
}

#[test]
fn columns_go_out_and_come_back_in_the_order_of_the_indexed_form() {
    let mut a = mesh(&grid(3));
    let e = a.edges().nth(7).expect("many");
    let new = a.split_edge_and_faces(e, DVec3::ONE).expect("finite");
    a.collapse_into_target(a.edge_halfedge(new.cuts[0].edge)).expect("a cut");
    fn round<K: meshwright::ElementKey>(a: &mut Mesh, keys: impl Fn(&Mesh) -> Vec<K>) {
        let column: Column<K, String> = a.add_column(String::new(), Rule::keep());
        for (i, k) in keys(a).into_iter().enumerate() {
            // Boundary half-edges have no corner.
            let _ = a.set_value(column, k, format!("value {i}"));
        }
        let out = a.export_column(column).expect("there");
        let mut b = Mesh::build(&a.to_indexed()).expect("valid");
        let text = serde_json_round(&out);
        let column = b.import_column::<K, _>(text, Rule::keep()).expect("as many");
        assert_eq!(b.export_column(column), Ok(out.clone()));
        let short = ColumnValues { default: String::new(), values: out.values[1..].to_vec() };
        let (values, elements) = (short.values.len(), out.values.len());
        assert_eq!(
            b.import_column::<K, _>(short, Rule::keep()),
            Err(ColumnError::Count { values, elements })
        );
    }
    round::<VertexKey>(&mut a, |m| m.vertices().collect());
    round::<HalfedgeKey>(&mut a, |m| m.halfedges().collect());
    round::<EdgeKey>(&mut a, |m| m.edges().collect());
    round::<FaceKey>(&mut a, |m| m.faces().collect());
}

#[cfg(feature = "serde")]
fn serde_json_round(values: &ColumnValues<String>) -> ColumnValues<String> {
    let text = serde_json::to_string(values).expect("serialises");
    serde_json::from_str(&text).expect("comes back")
}

#[cfg(not(feature = "serde"))]
fn serde_json_round(values: &ColumnValues<String>) -> ColumnValues<String> {
    values.clone()
}

#[test]
fn corners_go_out_in_the_order_of_the_pools_corners() {
    let mut mesh = mesh(&grid(3));
    let column = mesh.add_corner_column(DVec3::ZERO, Rule::keep());
    for h in mesh.halfedges().filter(|&h| !mesh.is_boundary(h)).collect::<Vec<_>>() {
        mesh.set_value(column, h, mesh.position(mesh.origin(h))).expect("inner");
    }
    let out = mesh.export_column(column).expect("there");
    let pool = mesh.to_indexed();
    let expected = pool.polygons().corners().iter().map(|&v| pool.positions()[v as usize]);
    assert!(out.values.iter().copied().eq(expected));
}

#[test]
fn carried_normals_are_mixed_and_stay_of_unit_length() {
    let mut mesh = mesh(&icosphere(2));
    mesh.compute_normals(NormalWeight::default());
    let e = mesh.edges().next().expect("many");
    let h = mesh.edge_halfedge(e);
    let ends = [mesh.origin(h), mesh.target(h)].map(|v| (mesh.position(v), mesh.normal(v).expect("carried")));
    let new = mesh.split_edge_and_faces(e, ends[0].0.midpoint(ends[1].0)).expect("finite");
    let normal = mesh.normal(new.vertex).expect("carried");
    assert!((normal.length() - 1.0).abs() < 1e-12);
    assert!(normal.distance((ends[0].1 + ends[1].1).normalize()) < 1e-9);
    let moved = mesh.normal(new.vertex);
    mesh.set_position(new.vertex, DVec3::ONE).expect("finite");
    assert_eq!(mesh.normal(new.vertex), moved);
}

#[test]
fn a_column_key_of_another_mesh_does_not_reach_attributes() {
    let key = two_squares().add_vertex_column(DVec3::ZERO, Rule::keep());
    let mut mesh = two_squares();
    let v = mesh.vertices().next().expect("six");
    mesh.set_normal(v, DVec3::X).expect("finite");
    assert_eq!(mesh.set_value(key, v, DVec3::NAN), Err(ColumnError::NoColumn));
    assert!(!mesh.remove_column(key));
    assert_eq!((mesh.validate(), mesh.normal(v)), (Ok(()), Some(DVec3::X)));
}
