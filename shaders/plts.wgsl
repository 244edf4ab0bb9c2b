// PLTS: point location with topological search (campagnolo-2021, 4.1.3).
//
// One thread = one pixel; dispatch covers the tile. Reads the grid and the transfer table, writes
// the target and the counters. The first sample of a ray is located through the acceleration grid;
// each next one by Newton's method in the same cell, then in the neighbor across the face that the
// result overshoots most, and through the acceleration grid again where the cells do not join.
// Departure from the paper: the start value is extrapolated with the last inverse Jacobian, so that
// one iteration usually does, and empty bins are skipped instead of rasterizing the hull. A ray that
// has done tile.work_limit loop iterations pauses: drivers end long loops without a word (llvmpipe
// after 65,535 iterations of all loops together), and no submission may run for long.
#import section
#import facing

const TOPOLOGICAL_LIMIT: u32 = 6u;
// Steps below this end the iteration while marching; the error left is of its square.
const MARCH_ENOUGH: f32 = 5e-4;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= tile.size) {
        return;
    }
    let pixel = tile.origin + id.xy;
    let ray = ray_of(pixel);
    let state = 2u * (id.y * tile.size.x + id.x);
    var sum = Accumulated(vec3f(0.0), 1.0);
    var n = 0.0;
    if tile.resume == 1u {
        n = bitcast<f32>(ray_states[state + 1u].x);
        if n == DONE {
            return;
        }
        let sums = bitcast<vec4f>(ray_states[state]);
        sum = Accumulated(sums.rgb, sums.a);
    } else {
        let section = section_color(ray);
        sum = Accumulated(section.rgb, 1.0 - section.a);
    }
    var cell: Cell;
    var s: Solution;
    var have_cell = false;
    var samples = 0u;
    var iterations = 0u;
    var topological_steps = 0u;
    var fallbacks = 0u;
    var work = 0u;
    // Two phases, so that rays side by side locate together and march together.
    while n < ray.count && is_open(sum) && work < tile.work_limit {
        while !have_cell && n < ray.count && work < tile.work_limit {
            let query = Query(ray.base + n * ray.advance, vec3f(0.0), MARCH_ENOUGH, frame.interpolation);
            let location = locate(query, ray.advance);
            fallbacks += 1u;
            iterations += location.iterations;
            work += location.work + 2u;
            have_cell = location.found;
            if location.found {
                cell = location.cell;
                s = location.solution;
            } else {
                n += location.skip;
            }
        }
        while have_cell {
            samples += 1u;
            var entry = transfer(evaluate(cell, clamp(s.uvw, vec3f(0.0), vec3f(1.0))).w);
            if is_ghost(cell.column, cell.layer) {
                entry = frame.ghost;
            }
            sum = accumulate(sum, entry);
            n += 1.0;
            if n >= ray.count || !is_open(sum) || work >= tile.work_limit {
                break;
            }
            let point = ray.base + n * ray.advance;
            let ahead = vec3f(dot(s.inverse_u, ray.advance), dot(s.inverse_v, ray.advance),
                dot(s.inverse_w, ray.advance));
            var start = clamp(s.uvw + ahead, vec3f(-1.0), vec3f(2.0));
            have_cell = false;
            for (var attempt = 0u; attempt <= TOPOLOGICAL_LIMIT; attempt++) {
                s = solve(cell, relative_to(cell, point), start, MARCH_ENOUGH);
                iterations += s.iterations;
                work += s.iterations + 2u;
                if s.inside {
                    have_cell = true;
                    break;
                }
                var next = s.uvw;
                if attempt == TOPOLOGICAL_LIMIT || !step_to_neighbor(&cell, &next) {
                    break;
                }
                topological_steps += 1u;
                start = next;
            }
        }
    }
    if n < ray.count && is_open(sum) {
        ray_states[state] = bitcast<vec4u>(vec4f(sum.color, sum.transmittance));
        ray_states[state + 1u] = vec4u(bitcast<u32>(n), 0u, 0u, 0u);
    } else {
        ray_states[state + 1u] = vec4u(bitcast<u32>(DONE), 0u, 0u, 0u);
        textureStore(target_image, vec2i(pixel), vec4f(sum.color, 1.0 - sum.transmittance));
        count(COUNT_FINISHED, 1u);
    }
    count(COUNT_SAMPLES, samples);
    count(COUNT_ITERATIONS, iterations);
    count(COUNT_STEPS, topological_steps);
    count(COUNT_FALLBACKS, fallbacks);
    count(COUNT_WORK, work);
}

// Loads the drawn cell that shares the whole face which `uvw` overshoots most; `uvw` becomes a start
// in it. False where the cells do not join: hull, fault, gap, a cell that is not drawn.
fn step_to_neighbor(cell: ptr<function, Cell>, uvw: ptr<function, vec3f>) -> bool {
    let q = *uvw;
    let excess = max(-q, q - vec3f(1.0));
    let axis = select(select(2u, 1u, excess.y >= excess.z), 0u, excess.x >= max(excess.y, excess.z));
    let plus = q[axis] > 0.5;
    let i = (*cell).column % grid.ni;
    let j = (*cell).column / grid.ni;
    let layer = (*cell).layer;
    var column = (*cell).column;
    var next_layer = layer;
    if axis == 0u {
        if (plus && i + 1u >= grid.ni) || (!plus && i == 0u) {
            return false;
        }
        column = select(column - 1u, column + 1u, plus);
    } else if axis == 1u {
        if (plus && j + 1u >= grid.nj) || (!plus && j == 0u) {
            return false;
        }
        column = select(column - grid.ni, column + grid.ni, plus);
    } else {
        if (plus && layer + 1u >= grid.nk) || (!plus && layer == 0u) {
            return false;
        }
        next_layer = select(layer - 1u, layer + 1u, plus);
    }
    if !is_drawn(column, next_layer) || !faces_join((*cell).column, layer, column, next_layer, axis, plus) {
        return false;
    }
    *cell = load_cell(column, next_layer, frame.interpolation);
    var start = q;
    start[axis] = select(q[axis] + 1.0, q[axis] - 1.0, plus);
    *uvw = clamp(start, vec3f(-1.0), vec3f(2.0));
    return true;
}

fn faces_join(a: u32, a_layer: u32, b: u32, b_layer: u32, axis: u32, plus: bool) -> bool {
    let a_lists = column_lists[a];
    if axis == 2u {
        let mine = depths_at(layer_entries(a_lists, a_layer, select(0u, 1u, plus)));
        return all_coincide(mine, depths_at(layer_entries(a_lists, b_layer, select(1u, 0u, plus))));
    }
    let face = 2u * axis + select(0u, 1u, plus);
    return sides_join(side_lists(a_lists, face), side_lists(column_lists[b], face ^ 1u), a_layer);
}
