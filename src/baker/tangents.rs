//! Tangents for meshes.

use super::{Baker, Ran};
use crate::error::{Error, Result};
use crate::mesh::{CornerAdjacency, Mesh};
use crate::ops::tangents::{
    Faces, Fans, Shading, Surface, TangentMethod, TangentOptions, TangentPlan, Tangents, finish,
};

/// Triangles that take one thread less time than it takes to wake others: some 20 microseconds.
const FEW: usize = 1 << 11;

impl Baker {
    /// Computes a tangent for every vertex of a mesh, and splits vertices whose triangles need different ones.
    ///
    /// ```
    /// use texbake::{Baker, Mesh, TangentOptions};
    ///
    /// // A square of which the texture's u grows along x, and v along -y.
    /// let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    /// let texcoords = vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    /// let square = Mesh::new(positions, texcoords, vec![[0, 1, 2], [0, 2, 3]])?.with_normals(vec![[0.0, 0.0, 1.0]; 4])?;
    /// let made = Baker::cpu().tangents(&square, &TangentOptions::default())?;
    /// assert_eq!(made.tangents, [[1.0, 0.0, 0.0, 1.0]; 4]);
    /// # Ok::<(), texbake::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Parameter`] if an option is out of range; [`Error::Device`] if a GPU without a fallback fails.
    pub fn tangents(&self, mesh: &Mesh, options: &TangentOptions) -> Result<Tangents> {
        Ok(self.tangents_with(mesh, None, options)?.1)
    }

    /// The same with an adjacency at hand, [`CornerAdjacency::of`] the mesh or one with the same triangles: for
    /// meshes that move. MikkTSpace, whose corners meet where all their attributes are equal, and flat normals make
    /// their own. Tells how it ran.
    ///
    /// # Errors
    /// As [`Baker::tangents`], and [`Error::Parameter`] if the adjacency has not a row for each vertex and each
    /// corner in one.
    pub fn tangents_with(
        &self,
        mesh: &Mesh,
        adjacency: Option<&CornerAdjacency>,
        options: &TangentOptions,
    ) -> Result<(Ran, Tangents)> {
        if let Some(degrees) = options.weld_seams.filter(|degrees| !(0.0..=90.0).contains(degrees)) {
            return Err(Error::parameter("weld-seams", degrees, "from 0 to 90 degrees"));
        }
        adjacency.map_or(Ok(()), |adjacency| check_fits(adjacency, mesh))?;
        match self.backend.host_threads().filter(|_| mesh.triangles().len() > FEW) {
            Some(threads) => threads.install(|| self.checked_tangents(mesh, adjacency, options)),
            None => self.checked_tangents(mesh, adjacency, options),
        }
    }

    fn checked_tangents(
        &self,
        mesh: &Mesh,
        adjacency: Option<&CornerAdjacency>,
        options: &TangentOptions,
    ) -> Result<(Ran, Tangents)> {
        let shading = Shading::new(mesh, options.missing_normals);
        let surface = Surface::new(&shading.mesh, &shading.normals, options.unwrap);
        let faces = Faces::of(&surface);
        let own;
        let fans = match (options.method, adjacency.filter(|_| !shading.has_own_vertices)) {
            (TangentMethod::Mikktspace, _) => Fans::of_mikktspace(&surface),
            (_, Some(adjacency)) => Fans::by_handedness(&surface, &faces, adjacency),
            (_, None) => {
                own = CornerAdjacency::of(&shading.mesh);
                Fans::by_handedness(&surface, &faces, &own)
            }
        };
        let plan = TangentPlan { method: options.method, precision: options.precision, surface: &surface, fans: &fans };
        let mut of_fans = vec![[0.0; 4]; fans.count()];
        let (ran, ()) = self.run(|backend| backend.tangents(&plan, &mut of_fans))?;
        Ok((ran, finish(mesh, &shading, &faces, &fans, of_fans, options)))
    }
}

/// Fails unless an adjacency has a row for each vertex of a mesh and holds as many corners.
fn check_fits(adjacency: &CornerAdjacency, mesh: &Mesh) -> Result<()> {
    let text = |vertices, corners| format!("of {vertices} vertices and {corners} corners");
    let given = text(adjacency.rows(), adjacency.corners().len());
    let wanted = text(mesh.positions().len(), 3 * mesh.triangles().len());
    if given == wanted { Ok(()) } else { Err(Error::parameter("adjacency", given, wanted)) }
}
