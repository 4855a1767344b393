// The tangent of each fan.

struct Tangent {
    t: vec3<u32>,
    turned: u32,     // the sign bit of the handedness
    computed: bool,  // whether the frames it is made of are this job's
}

@compute @workgroup_size(64, 1, 1)
fn tangents(@builtin(global_invocation_id) id: vec3<u32>) {
    let fan = params.first + id.x;
    if (fan >= params.end) {
        return;
    }
    let n = vector_at(params.normals + 3u * fan);
    let begin = inputs[params.offsets + fan];
    let end = inputs[params.offsets + fan + 1u];
    let tangent = tangent_of(n, begin, select(end, begin, end - begin > params.longest_row));
    let at = params.tangents + 4u * fan;
    store(at, tangent.t);
    outputs[at + 3u] = select(0u, params.nonce | tangent.turned, tangent.computed);
}

// Whether a frame's word of proof is this job's.
fn is_computed(proof: u32) -> bool {
    return (proof & ~SIGN) == params.nonce;
}
