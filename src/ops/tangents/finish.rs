//! From the tangents of fans to those of vertices: directions for those that have none, seams, and splits.

use super::pieces::{of_pieces, of_pieces_mut};
use super::seams::weld_seams;
use super::{Faces, Fans, Shading, TangentOptions, is_zero, project, unit};
use crate::error::{Error, Result};
use crate::map::Convention;
use crate::mesh::Mesh;
use crate::vector::{cross, times};
use std::borrow::Cow;
use std::iter::Sum;

/// Tangents of a mesh, whose vertices may have been split.
///
/// The first vertices are the mesh's own, in their order; those that follow are copies of some of them, for corners
/// with another tangent or another normal.
#[derive(Debug, Clone, PartialEq)]
pub struct Tangents {
    /// Of each vertex: the tangent, a unit vector, and in w the sign of the bitangent, 1 or -1.
    pub tangents: Vec<[f32; 4]>,
    /// Of each vertex, if the mesh's own were missing or had to be repaired.
    pub normals: Option<Vec<[f32; 3]>>,
    /// The mesh's vertex that each of the vertices beyond its own is a copy of.
    pub copies: Vec<u32>,
    /// The vertices of each triangle; `None` if they are the mesh's own.
    pub triangles: Option<Vec<[u32; 3]>>,
    /// What was found on the way.
    pub report: TangentReport,
}

/// What was found in a mesh, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct TangentReport {
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Its vertices.
    pub vertices: usize,
    /// Copies of vertices that were made.
    pub copies: usize,
    /// Vertices shared by triangles of both handednesses, which were split: the mapping is mirrored there.
    pub mirrored: usize,
    /// Triangles without area in space.
    pub without_area: usize,
    /// Triangles without area in the texture.
    pub without_texture_area: usize,
    /// Triangles whose u spans more than half the texture, and not more than all of it: those that
    /// [`TangentOptions::unwrap`] is for.
    pub jumps: usize,
    /// Vertices that no triangle uses; their tangent is any at a right angle to the normal.
    pub unused: usize,
    /// Vertices for which no direction was left: tangents cancel, or no triangle around has one. Their tangent is any
    /// at a right angle to the normal.
    pub undirected: usize,
    /// Vertices whose normal was missing or zero.
    pub normals_made: usize,
    /// Vertices whose normal was not of unit length.
    pub normals_normalised: usize,
    /// Vertices whose tangent was set equal to another's across a seam.
    pub welded: usize,
}

impl Sum for TangentReport {
    fn sum<I: Iterator<Item = Self>>(reports: I) -> Self {
        reports.fold(Self::default(), |a, b| Self {
            triangles: a.triangles + b.triangles,
            vertices: a.vertices + b.vertices,
            copies: a.copies + b.copies,
            mirrored: a.mirrored + b.mirrored,
            without_area: a.without_area + b.without_area,
            without_texture_area: a.without_texture_area + b.without_texture_area,
            jumps: a.jumps + b.jumps,
            unused: a.unused + b.unused,
            undirected: a.undirected + b.undirected,
            normals_made: a.normals_made + b.normals_made,
            normals_normalised: a.normals_normalised + b.normals_normalised,
            welded: a.welded + b.welded,
        })
    }
}

impl Tangents {
    /// The mesh's vertex that each vertex is.
    pub fn sources(&self) -> impl Iterator<Item = u32> {
        let own = (self.tangents.len() - self.copies.len()) as u32;
        (0..own).chain(self.copies.iter().copied())
    }

    /// The bitangent of each vertex, w (n x t) (FGED2 eq. 7.40).
    ///
    /// # Errors
    /// [`Error::Parameter`] if `mesh` is not the one that the tangents are of: it has more or fewer vertices, or no
    /// normals although its normals were used.
    pub fn bitangents(&self, mesh: &Mesh) -> Result<Vec<[f32; 3]>> {
        let own = self.tangents.len() - self.copies.len();
        let normals: Vec<[f32; 3]> = match (&self.normals, mesh.normals()) {
            (Some(normals), _) if mesh.positions().len() == own => normals.clone(),
            (None, Some(normals)) if normals.len() == own => {
                self.sources().map(|source| normals[source as usize]).collect()
            }
            _ => {
                let value = format!("one of {} vertices", mesh.positions().len());
                return Err(Error::parameter("mesh", value, format!("the one of {own} that the tangents are of")));
            }
        };
        let bitangent = |(n, &[x, y, z, w]): (_, &[f32; 4])| times(w, cross(n, [x, y, z]));
        Ok(normals.into_iter().zip(&self.tangents).map(bitangent).collect())
    }

    /// Three components: the sign is the lowest bit of x, 1 for minus (FGED2 section 7.5). It moves x by at most one
    /// step of a float.
    pub fn with_sign_in_lowest_bit(&self) -> Vec<[f32; 3]> {
        let packed = |&[x, y, z, w]: &[f32; 4]| [f32::from_bits((x.to_bits() & !1) | u32::from(w < 0.0)), y, z];
        self.tangents.iter().map(packed).collect()
    }
}

/// Gives each vertex of `mesh` the tangent of its corners' fan, and splits it where they differ.
pub(crate) fn finish(
    mesh: &Mesh,
    shading: &Shading<'_>,
    faces: &Faces,
    fans: &Fans<'_>,
    mut of_fans: Vec<[f32; 4]>,
    options: &TangentOptions,
) -> Tangents {
    let is_directed = of_pieces_mut(&mut of_fans, |first, tangents| {
        let of_fan = |(fan, tangent): (usize, &mut [f32; 4])| {
            let [x, y, z, w] = *tangent;
            let is_directed = !is_zero([x, y, z]);
            let [x, y, z] = if is_directed { [x, y, z] } else { across(shading.normals[fans.vertex(fan)]) };
            *tangent = [x, y, z, sign_of_green(options.convention, w)];
            is_directed
        };
        (first..).zip(tangents).map(of_fan).collect::<Vec<bool>>()
    });
    let is_directed = is_directed.concat();
    let mut vertices = if fans.owners.is_none() && !shading.has_own_vertices {
        Vertices::unsplit(mesh, shading, of_fans, is_directed)
    } else {
        Vertices::split(mesh, shading, fans, &of_fans, &is_directed, options.convention)
    };
    let welded = options.weld_seams.map_or(0, |angle| weld_seams(mesh, &mut vertices, angle));
    let report = TangentReport {
        triangles: mesh.triangles().len(),
        vertices: mesh.positions().len(),
        copies: vertices.copies.len(),
        mirrored: vertices.mirrored,
        unused: vertices.unused,
        without_area: faces.counts.without_area,
        without_texture_area: faces.counts.without_texture_area,
        jumps: faces.counts.jumps,
        undirected: vertices.is_directed.iter().filter(|&&is_directed| !is_directed).count() - vertices.unused,
        normals_made: shading.made,
        normals_normalised: shading.normalised,
        welded,
    };
    let has_own_normals = shading.made + shading.normalised == 0;
    Tangents {
        tangents: vertices.tangents,
        normals: (!has_own_normals).then(|| vertices.normals.into_owned()),
        copies: vertices.copies,
        triangles: vertices.triangles,
        report,
    }
}

/// Vertices with one normal and one tangent each: the mesh's own, then copies.
pub(super) struct Vertices<'a> {
    pub tangents: Vec<[f32; 4]>,
    pub normals: Cow<'a, [[f32; 3]]>,
    /// Whether the tangent is more than any at a right angle to the normal.
    pub is_directed: Vec<bool>,
    /// The mesh's vertex that each copy is of.
    pub copies: Vec<u32>,
    /// `None` if they are the mesh's own.
    pub triangles: Option<Vec<[u32; 3]>>,
    /// Vertices that were split because their corners differ in handedness.
    pub mirrored: usize,
    /// Vertices that no triangle uses.
    pub unused: usize,
}

/// No copy.
const NONE: u32 = u32::MAX;

impl<'a> Vertices<'a> {
    /// Each fan is a vertex.
    fn unsplit(mesh: &Mesh, shading: &'a Shading<'_>, tangents: Vec<[f32; 4]>, is_directed: Vec<bool>) -> Self {
        let unused = if is_directed.iter().all(|&is_directed| is_directed) {
            0
        } else {
            let mut is_used = vec![false; tangents.len()];
            mesh.triangles().as_flattened().iter().for_each(|&vertex| is_used[vertex as usize] = true);
            is_used.iter().filter(|&&is_used| !is_used).count()
        };
        let normals = Cow::Borrowed(&*shading.normals);
        Self { tangents, normals, is_directed, copies: Vec::new(), triangles: None, mirrored: 0, unused }
    }

    /// Each vertex takes the normal and the tangent of its first corner; corners that have others become copies.
    fn split(
        mesh: &Mesh,
        shading: &'a Shading<'_>,
        fans: &Fans<'_>,
        of_fans: &[[f32; 4]],
        fan_is_directed: &[bool],
        convention: Convention,
    ) -> Self {
        let indices = mesh.triangles().as_flattened();
        let shaded = shading.mesh.triangles().as_flattened();
        let fan = |corner: usize| fans.owners.as_ref().map_or(shaded[corner], |owners| owners.fans[corner]) as usize;
        let normal = |corner: usize| shading.normals[shaded[corner] as usize];
        let first = first_corners(indices, mesh.positions().len());
        let normals: Cow<'_, [[f32; 3]]> = if shading.has_own_vertices {
            first.iter().map(|&first| if first == NONE { [0.0, 0.0, 1.0] } else { normal(first as usize) }).collect()
        } else {
            Cow::Borrowed(&shading.normals)
        };
        let mut tangents = vec![[0.0; 4]; first.len()];
        let of_first = of_pieces_mut(&mut tangents, |vertex, tangents| {
            let of_vertex = |(vertex, tangent): (usize, &mut [f32; 4])| {
                if first[vertex] == NONE {
                    let [x, y, z] = across(normals[vertex]);
                    *tangent = [x, y, z, sign_of_green(convention, NO_SIGN)];
                    return (NONE, false);
                }
                let fan = fan(first[vertex] as usize);
                *tangent = of_fans[fan];
                (fan as u32, fan_is_directed[fan])
            };
            (vertex..).zip(tangents).map(of_vertex).unzip::<u32, bool, Vec<_>, Vec<_>>()
        });
        let (fan_of_vertex, is_directed): (Vec<_>, Vec<_>) = of_first.into_iter().unzip();
        let fan_of_vertex = fan_of_vertex.concat();
        let mut this = Self {
            tangents,
            normals,
            is_directed: is_directed.concat(),
            copies: Vec::new(),
            triangles: None,
            mirrored: 0,
            unused: first.iter().filter(|&&first| first == NONE).count(),
        };

        // Corners that do not have their vertex's normal and tangent: few, and most others have its fan.
        let differ = of_pieces(indices, |corner, indices| {
            let differs = |&(corner, &vertex): &(usize, &u32)| {
                let (fan, vertex) = (fan(corner), vertex as usize);
                (shading.has_own_vertices || fan != fan_of_vertex[vertex] as usize)
                    && (bits(normal(corner)), bits(of_fans[fan]))
                        != (bits(this.normals[vertex]), bits(this.tangents[vertex]))
            };
            (corner..).zip(indices).filter(differs).map(|(corner, _)| corner).collect::<Vec<usize>>()
        });
        if differ.iter().all(Vec::is_empty) {
            return this;
        }
        let mut triangles = mesh.triangles().to_vec();
        // The next copy of the same vertex.
        let mut next = vec![NONE; first.len()];
        let mut is_mirrored = vec![false; first.len()];
        let normals = this.normals.to_mut();
        for corner in differ.into_iter().flatten() {
            let index = &mut triangles.as_flattened_mut()[corner];
            let (normal, tangent) = (normal(corner), of_fans[fan(corner)]);
            let vertex = *index as usize;
            let mut at = vertex;
            while (bits(normals[at]), bits(this.tangents[at])) != (bits(normal), bits(tangent)) {
                if next[at] == NONE {
                    next[at] = this.tangents.len() as u32;
                    next.push(NONE);
                    normals.push(normal);
                    this.tangents.push(tangent);
                    this.is_directed.push(fan_is_directed[fan(corner)]);
                    this.copies.push(*index);
                }
                at = next[at] as usize;
                // Where there is no direction, there is no handedness either.
                let are_directed = this.is_directed[vertex] && fan_is_directed[fan(corner)];
                is_mirrored[vertex] |= are_directed && this.tangents[vertex][3] != tangent[3];
            }
            *index = at as u32;
        }
        this.mirrored = is_mirrored.iter().filter(|&&is_mirrored| is_mirrored).count();
        this.triangles = Some(triangles);
        this
    }
}

/// What w is, as to growing v, where nothing decides.
const NO_SIGN: f32 = -1.0;

/// The sign of the bitangent of a normal map, for the sign w of one along growing v: green up is against v.
fn sign_of_green(convention: Convention, w: f32) -> f32 {
    match convention {
        Convention::Gl => -w,
        Convention::Dx => w,
    }
}

/// The first corner of each vertex, or [`NONE`].
fn first_corners(indices: &[u32], vertices: usize) -> Vec<u32> {
    let mut first = vec![NONE; vertices];
    for (corner, &vertex) in indices.iter().enumerate().rev() {
        first[vertex as usize] = corner as u32;
    }
    first
}

fn bits<const N: usize>(vector: [f32; N]) -> [u32; N] {
    vector.map(f32::to_bits)
}

/// A unit vector at a right angle to n: the axis that is furthest from it, projected.
fn across(n: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = n.map(f32::abs);
    let axis = if x <= y && x <= z {
        [1.0, 0.0, 0.0]
    } else if y <= z {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    unit(project(n, axis))
}
