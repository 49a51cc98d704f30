//! Attributes on the half-edge mesh: columns like those of the user, kept finite.

use super::{Attributes, FaceGroups, GroupName};
use crate::column::{Column, Event, Interpolate, Kind, Rule, Store, Value};
use crate::matching::NONE;
use crate::mesh::read;
use crate::report::Attribute;
use crate::{EdgeKey, FaceKey, HalfedgeKey, Mesh, VertexKey};
use glam::{DVec2, DVec3};

/// The columns of the attributes that a mesh carries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carried {
    pub(crate) normals: Option<Column<VertexKey, DVec3>>,
    colors: Option<Column<VertexKey, [f32; 4]>>,
    pub(crate) corner_normals: Option<Column<HalfedgeKey, Option<DVec3>>>,
    uvs: Option<Column<HalfedgeKey, Option<DVec2>>>,
    /// Indices into `names`; [`NONE`] for a face in no group.
    pub(crate) groups: Option<Column<FaceKey, u32>>,
    names: Vec<GroupName>,
    material_files: Vec<String>,
}

impl Carried {
    /// Whether a column is one of these: what is written to it must be finite, whoever has a key.
    pub(crate) fn holds(&self, kind: Kind, index: u32) -> bool {
        let [first, second] = match kind {
            Kind::Vertex => [self.normals.map(|c| c.index), self.colors.map(|c| c.index)],
            Kind::Corner => [self.corner_normals.map(|c| c.index), self.uvs.map(|c| c.index)],
            Kind::Edge => [None; 2],
            Kind::Face => [self.groups.map(|c| c.index), None],
        };
        first == Some(index) || second == Some(index)
    }

    /// Where the columns are.
    pub(crate) fn columns(&self) -> Vec<(Kind, u32)> {
        let on_vertices = [self.normals.map(|c| c.index), self.colors.map(|c| c.index)];
        let on_corners = [self.corner_normals.map(|c| c.index), self.uvs.map(|c| c.index)];
        let on_faces = [self.groups.map(|c| c.index)];
        let of =
            |kind, list: &[Option<u32>]| list.iter().flatten().map(move |&i| (kind, i)).collect::<Vec<_>>();
        [of(Kind::Vertex, &on_vertices), of(Kind::Corner, &on_corners), of(Kind::Face, &on_faces)].concat()
    }

    /// Follows the columns on a kind of element to behind so many others.
    pub(crate) fn renumber(&mut self, kind: Kind, by: u32) {
        fn moved<K, T>(column: &mut Option<Column<K, T>>, by: u32) {
            *column = column.map(|c| Column::new(c.index + by));
        }
        match kind {
            Kind::Vertex => {
                moved(&mut self.normals, by);
                moved(&mut self.colors, by);
            }
            Kind::Corner => {
                moved(&mut self.corner_normals, by);
                moved(&mut self.uvs, by);
            }
            Kind::Edge => {}
            Kind::Face => moved(&mut self.groups, by),
        }
    }
}

/// Why an attribute was not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SetAttributeError {
    /// The key names no live element.
    #[error("the element is not in the mesh")]
    Missing,
    /// The half-edge has no face, so there is no corner.
    #[error("{0:?} is a boundary half-edge: it has no corner")]
    NoCorner(HalfedgeKey),
    /// The value is NaN or infinite.
    #[error("the value is not finite")]
    NonFinite,
}

/// Interpolates, but for sums beyond the largest number: there the first source stays.
fn finite_rule<T: Value + Interpolate>(is_finite: fn(&T) -> bool) -> Rule<T> {
    Rule::custom(move |event, sources: &[(&T, f64)]| match sources {
        [(own, _), ..] if event == Event::Move => (*own).clone(),
        _ => Some(T::mix(sources)).filter(is_finite).unwrap_or_else(|| sources[0].0.clone()),
    })
}

fn is_finite_color(color: &[f32; 4]) -> bool {
    color.iter().all(|part| part.is_finite())
}

fn is_finite_uv(uv: &Option<DVec2>) -> bool {
    uv.is_none_or(|uv| uv.is_finite())
}

const WHITE: [f32; 4] = [1.0; 4];

/// # Attributes
impl Mesh {
    /// The attributes the mesh carries.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{Attribute, IndexedMesh, Mesh, NormalWeight, glam::DVec3};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// mesh.compute_normals(NormalWeight::Area);
    /// assert_eq!(mesh.carried_attributes(), [Attribute::VertexNormals]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn carried_attributes(&self) -> Vec<Attribute> {
        let carried = &self.carried;
        let present = [
            (Attribute::VertexNormals, carried.normals.is_some()),
            (Attribute::VertexColors, carried.colors.is_some()),
            (Attribute::CornerNormals, carried.corner_normals.is_some()),
            (Attribute::TextureCoordinates, carried.uvs.is_some()),
            (Attribute::Groups, carried.groups.is_some()),
            (Attribute::MaterialFiles, !carried.material_files.is_empty()),
        ];
        present.into_iter().filter(|p| p.1).map(|p| p.0).collect()
    }

    /// Lets go of an attribute. Whether the mesh carried it. O(1).
    pub fn drop_attribute(&mut self, attribute: Attribute) -> bool {
        let carried = &mut self.carried;
        match attribute {
            Attribute::VertexNormals => carried.normals.take().is_some_and(|c| self.remove_column(c)),
            Attribute::VertexColors => carried.colors.take().is_some_and(|c| self.remove_column(c)),
            Attribute::CornerNormals => carried.corner_normals.take().is_some_and(|c| self.remove_column(c)),
            Attribute::TextureCoordinates => carried.uvs.take().is_some_and(|c| self.remove_column(c)),
            Attribute::Groups => {
                carried.names.clear();
                carried.groups.take().is_some_and(|c| self.remove_column(c))
            }
            Attribute::MaterialFiles => !std::mem::take(&mut carried.material_files).is_empty(),
        }
    }

    read! {
        /// The normal a vertex carries, if the mesh carries normals: one that was given, or
        /// [computed](Self::compute_normals). Operators mix normals where they merge vertices; moving a vertex does not
        /// change its normal.
        normal, get_normal(self, v: VertexKey => vertex_slot) -> Option<DVec3> {
            self.normal_column().and_then(|n| n.get(v).copied())
        }
    }

    read! {
        /// The colour of a vertex as RGBA in 0..=1, if the mesh carries colours.
        color, get_color(self, v: VertexKey => vertex_slot) -> Option<[f32; 4]> {
            self.stored(Kind::Vertex, self.carried.colors, v)
        }
    }

    read! {
        /// The normal of the corner at the start of a half-edge, if it has one.
        corner_normal, get_corner_normal(self, h: HalfedgeKey => halfedge_slot) -> Option<DVec3> {
            self.stored(Kind::Corner, self.carried.corner_normals, h).flatten()
        }
    }

    read! {
        /// The texture coordinates of the corner at the start of a half-edge, if it has any.
        uv, get_uv(self, h: HalfedgeKey => halfedge_slot) -> Option<DVec2> {
            self.stored(Kind::Corner, self.carried.uvs, h).flatten()
        }
    }

    /// The group of a face, if it is in one; `None` on a dead key too.
    pub fn group(&self, f: FaceKey) -> Option<&GroupName> {
        let group = self.stored(Kind::Face, self.carried.groups, self.face_slot(f)?)?;
        self.carried.names.get(group as usize).filter(|name| !name.says_nothing())
    }

    /// Whether texture coordinates differ across an edge, at either of its ends. `false` on the boundary and on a dead
    /// key.
    pub fn is_uv_seam(&self, e: EdgeKey) -> bool {
        self.carried.uvs.is_some_and(|uvs| self.is_seam(uvs, e))
    }

    /// Sets the normal of a vertex; if the mesh carried none, all others become zero. O(1), but for the first.
    ///
    /// # Errors
    /// [`SetAttributeError`]; nothing has changed then.
    pub fn set_normal(&mut self, v: VertexKey, normal: DVec3) -> Result<(), SetAttributeError> {
        let slot = self.vertex_slot(v).ok_or(SetAttributeError::Missing)?;
        if !normal.is_finite() {
            return Err(SetAttributeError::NonFinite);
        }
        let column = match self.carried.normals {
            Some(column) => column,
            None => self.add_column(DVec3::ZERO, Rule::normals()),
        };
        self.carried.normals = Some(column);
        self.write_value(Kind::Vertex, column.index, slot, normal);
        Ok(())
    }

    /// Sets the colour of a vertex; if the mesh carried none, all others become white. O(1), but for the first.
    ///
    /// # Errors
    /// [`SetAttributeError`]; nothing has changed then.
    pub fn set_color(&mut self, v: VertexKey, color: [f32; 4]) -> Result<(), SetAttributeError> {
        let slot = self.vertex_slot(v).ok_or(SetAttributeError::Missing)?;
        if !is_finite_color(&color) {
            return Err(SetAttributeError::NonFinite);
        }
        let column = match self.carried.colors {
            Some(column) => column,
            None => self.add_column(WHITE, finite_rule(is_finite_color)),
        };
        self.carried.colors = Some(column);
        self.write_value(Kind::Vertex, column.index, slot, color);
        Ok(())
    }

    /// Sets or takes away the normal of the corner at the start of a half-edge. O(1), but for the first.
    ///
    /// # Errors
    /// [`SetAttributeError`]; nothing has changed then.
    pub fn set_corner_normal(
        &mut self,
        h: HalfedgeKey,
        normal: Option<DVec3>,
    ) -> Result<(), SetAttributeError> {
        let slot = self.corner_slot(h)?;
        if normal.is_some_and(|n| !n.is_finite()) {
            return Err(SetAttributeError::NonFinite);
        }
        let column = match self.carried.corner_normals {
            Some(column) => column,
            None => self.add_column(None, Rule::normals()),
        };
        self.carried.corner_normals = Some(column);
        self.write_value(Kind::Corner, column.index, slot, normal);
        Ok(())
    }

    /// Sets or takes away the texture coordinates of the corner at the start of a half-edge. O(1), but for the first.
    ///
    /// # Errors
    /// [`SetAttributeError`]; nothing has changed then.
    ///
    /// # Examples
    /// ```
    /// # use meshwright::{IndexedMesh, Mesh, glam::{DVec3, dvec2}};
    /// # let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    /// # let mut mesh = Mesh::build(&IndexedMesh::from_triangles(points, &[[0, 1, 2]])?)?;
    /// let f = mesh.faces().next().unwrap();
    /// for h in mesh.face_halfedges(f).collect::<Vec<_>>() {
    ///     mesh.set_uv(h, Some(mesh.position(mesh.origin(h)).truncate()))?;
    /// }
    /// // Edits keep it up.
    /// let h = mesh.face_halfedge(f);
    /// let new = mesh.split_edge(mesh.edge(h), DVec3::X * 0.25)?;
    /// let corner = mesh.next(h);
    /// assert_eq!((mesh.origin(corner), mesh.uv(corner)), (new.vertex, Some(dvec2(0.25, 0.0))));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_uv(&mut self, h: HalfedgeKey, uv: Option<DVec2>) -> Result<(), SetAttributeError> {
        let slot = self.corner_slot(h)?;
        if !is_finite_uv(&uv) {
            return Err(SetAttributeError::NonFinite);
        }
        let column = match self.carried.uvs {
            Some(column) => column,
            None => self.add_column(None, finite_rule(is_finite_uv)),
        };
        self.carried.uvs = Some(column);
        self.write_value(Kind::Corner, column.index, slot, uv);
        Ok(())
    }

    /// Puts a face into the group of this name and material, or into none. O(groups).
    ///
    /// # Errors
    /// [`SetAttributeError::Missing`]; nothing has changed then.
    pub fn set_group(&mut self, f: FaceKey, group: Option<GroupName>) -> Result<(), SetAttributeError> {
        let slot = self.face_slot(f).ok_or(SetAttributeError::Missing)?;
        let column = match self.carried.groups {
            Some(column) => column,
            None => self.add_column(NONE, Rule::keep()),
        };
        self.carried.groups = Some(column);
        let names = &mut self.carried.names;
        let index = match group {
            None => NONE,
            Some(name) => match names.iter().position(|known| *known == name) {
                Some(at) => at as u32,
                None => {
                    names.push(name);
                    names.len() as u32 - 1
                }
            },
        };
        self.write_value(Kind::Face, column.index, slot, index);
        Ok(())
    }

    fn corner_slot(&self, h: HalfedgeKey) -> Result<u32, SetAttributeError> {
        let slot = self.halfedge_slot(h).ok_or(SetAttributeError::Missing)?;
        if self.face[slot as usize] == NONE { Err(SetAttributeError::NoCorner(h)) } else { Ok(slot) }
    }

    fn stored<K, T: Value>(&self, kind: Kind, column: Option<Column<K, T>>, slot: u32) -> Option<T> {
        self.columns.store::<T>(kind, column?.index)?.get(slot).cloned()
    }

    pub(crate) fn normal_column(&self) -> Option<&Store<DVec3>> {
        self.columns.store(Kind::Vertex, self.carried.normals?.index)
    }

    /// Lets the mesh carry these normals, given by slot.
    pub(crate) fn replace_normals(&mut self, normals: Vec<DVec3>) {
        match self.carried.normals {
            Some(column) => {
                for v in self.vertices.live().collect::<Vec<_>>() {
                    self.write_value(Kind::Vertex, column.index, v, normals[v as usize]);
                }
            }
            None => {
                self.carried.normals =
                    Some(self.column_of(Kind::Vertex, normals, DVec3::ZERO, Rule::normals()));
            }
        }
    }

    fn column_of<K, T: Value>(
        &mut self,
        kind: Kind,
        values: Vec<T>,
        default: T,
        rule: Rule<T>,
    ) -> Column<K, T> {
        Column::new(self.columns.add(kind, Store::of(values, default, rule)))
    }

    /// Takes over the attributes of the pool that a fresh mesh was built from; `halfedge_of` gives the half-edge of each
    /// corner.
    pub(crate) fn adopt(&mut self, attributes: &Attributes, halfedge_of: impl Fn(usize) -> u32) {
        /// Values by slot, which begin at 1.
        fn shifted<T: Clone>(values: &[T], default: T) -> Vec<T> {
            let mut column = Vec::with_capacity(values.len() + 1);
            column.push(default);
            column.extend_from_slice(values);
            column
        }
        fn spread<T: Copy>(values: &[Option<T>], slots: usize, at: impl Fn(usize) -> u32) -> Vec<Option<T>> {
            let mut column = vec![None; slots];
            values.iter().enumerate().for_each(|(corner, value)| column[at(corner) as usize] = *value);
            column
        }
        let corners = self.next.len();
        if let Some(normals) = &attributes.vertex_normals {
            self.replace_normals(shifted(normals, DVec3::ZERO));
        }
        if let Some(colors) = &attributes.vertex_colors {
            let rule = finite_rule(is_finite_color);
            let column = self.column_of(Kind::Vertex, shifted(colors, WHITE), WHITE, rule);
            self.carried.colors = Some(column);
        }
        if let Some(normals) = &attributes.corner_normals {
            let values = spread(normals, corners, &halfedge_of);
            self.carried.corner_normals = Some(self.column_of(Kind::Corner, values, None, Rule::normals()));
        }
        if let Some(uvs) = &attributes.corner_uvs {
            let values = spread(uvs, corners, &halfedge_of);
            self.carried.uvs = Some(self.column_of(Kind::Corner, values, None, finite_rule(is_finite_uv)));
        }
        if let Some(groups) = &attributes.face_groups {
            self.carried.names.clone_from(&groups.names);
            self.carried.groups =
                Some(self.column_of(Kind::Face, shifted(&groups.of, NONE), NONE, Rule::keep()));
        }
        self.carried.material_files.clone_from(&attributes.material_files);
    }

    /// The attributes in the order of the indexed form, whose vertices are `order`.
    pub(crate) fn ordered_attributes(&self, order: &[u32]) -> Attributes {
        let carried = &self.carried;
        let on_corners = carried.corner_normals.is_some() || carried.uvs.is_some();
        let corners = if on_corners { self.ordered_slots(Kind::Corner) } else { Vec::new() };
        let faces = if carried.groups.is_some() { self.ordered_slots(Kind::Face) } else { Vec::new() };
        let groups = self.picked(Kind::Face, carried.groups, &faces);
        Attributes {
            vertex_normals: self.picked(Kind::Vertex, carried.normals, order),
            vertex_colors: self.picked(Kind::Vertex, carried.colors, order),
            corner_normals: self.picked(Kind::Corner, carried.corner_normals, &corners),
            corner_uvs: self.picked(Kind::Corner, carried.uvs, &corners),
            face_groups: groups.map(|of| with_names(of, &carried.names)),
            material_files: carried.material_files.clone(),
        }
    }

    fn picked<K, T: Value>(&self, kind: Kind, column: Option<Column<K, T>>, slots: &[u32]) -> Option<Vec<T>> {
        let store = self.columns.store::<T>(kind, column?.index)?;
        // Of no elements there are no attributes.
        Some(slots.iter().filter_map(|&slot| store.get(slot).cloned()).collect())
            .filter(|v: &Vec<T>| !v.is_empty())
    }
}

/// Groups by index, where faces in none get the nameless group.
fn with_names(mut of: Vec<u32>, names: &[GroupName]) -> FaceGroups {
    let mut names = names.to_vec();
    if of.contains(&NONE) {
        let nameless = names.iter().position(GroupName::says_nothing).unwrap_or_else(|| {
            names.push(GroupName::default());
            names.len() - 1
        });
        of.iter_mut().filter(|g| **g == NONE).for_each(|g| *g = nameless as u32);
    }
    FaceGroups { names, of }
}
