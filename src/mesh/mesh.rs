//! Triangles that share vertices.

use crate::error::{Error, Result};

/// Triangles that share vertices: what a normal map is mapped on.
///
/// Positions are in any unit, counterclockwise seen from outside; texture coordinates have u to the right and v down
/// the rows of the image, as in glTF. All numbers are finite, and every index is in range.
///
/// ```
/// use texbake::Mesh;
///
/// let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let texcoords = vec![[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]];
/// let mesh = Mesh::new(positions, texcoords, vec![[0, 1, 2]])?.with_normals(vec![[0.0, 0.0, 1.0]; 3])?;
/// assert_eq!(mesh.triangles(), [[0, 1, 2]]);
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    positions: Vec<[f32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    texcoords: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A mesh without normals: one position and one texture coordinate for each vertex, three vertices for each
    /// triangle.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there are more or fewer texture coordinates than positions, an index is out of range,
    /// or there are more than 2^30 vertices or 2^29 triangles; [`Error::Vertex`] for a number that is NaN or infinite.
    pub fn new(positions: Vec<[f32; 3]>, texcoords: Vec<[f32; 2]>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        check_count("number of texture coordinates", texcoords.len(), positions.len())?;
        check_finite("position", &positions)?;
        check_finite("texture coordinate", &texcoords)?;
        // Vertices, corners and copies of vertices are all counted in 32 bits.
        for (parameter, count, greatest) in
            [("number of vertices", positions.len(), 1 << 30), ("number of triangles", triangles.len(), 1 << 29)]
        {
            if count > greatest {
                return Err(Error::parameter(parameter, count, format!("at most {greatest}")));
            }
        }
        let in_range = |index: &u32| (*index as usize) < positions.len();
        if let Some(triangle) = triangles.iter().position(|triangle| !triangle.iter().all(in_range)) {
            let corners = triangles[triangle];
            let wrong = corners.into_iter().find(|index| !in_range(index)).unwrap_or_default();
            let range = format!("below {}, the number of vertices", positions.len());
            return Err(Error::parameter("index", format!("{wrong} (triangle {triangle}: {corners:?})"), range));
        }
        Ok(Self { positions, normals: None, texcoords, triangles })
    }

    /// The same with a normal for each vertex, of any length; a zero counts as missing.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there are more or fewer normals than positions; [`Error::Vertex`] for a number that is
    /// NaN or infinite.
    pub fn with_normals(mut self, normals: Vec<[f32; 3]>) -> Result<Self> {
        check_count("number of normals", normals.len(), self.positions.len())?;
        check_finite("normal", &normals)?;
        self.normals = Some(normals);
        Ok(self)
    }

    /// Its triangles with three vertices of their own each, without normals.
    pub(crate) fn unshared(&self) -> Self {
        let corners = self.triangles.as_flattened();
        let positions = corners.iter().map(|&vertex| self.positions[vertex as usize]).collect();
        let texcoords = corners.iter().map(|&vertex| self.texcoords[vertex as usize]).collect();
        let triangles = (0..self.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Self { positions, normals: None, texcoords, triangles }
    }

    /// Of each vertex.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Of each vertex, if the mesh has normals.
    pub fn normals(&self) -> Option<&[[f32; 3]]> {
        self.normals.as_deref()
    }

    /// Of each vertex.
    pub fn texcoords(&self) -> &[[f32; 2]] {
        &self.texcoords
    }

    /// The vertices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
}

fn check_count(parameter: &'static str, count: usize, vertices: usize) -> Result<()> {
    if count == vertices {
        return Ok(());
    }
    Err(Error::parameter(parameter, count, format!("{vertices}, one for each position")))
}

fn check_finite<const N: usize>(attribute: &'static str, values: &[[f32; N]]) -> Result<()> {
    match values.iter().position(|value| !value.iter().all(|part| part.is_finite())) {
        None => Ok(()),
        Some(vertex) => Err(Error::Vertex { attribute, vertex, value: format!("{:?}", values[vertex]) }),
    }
}
