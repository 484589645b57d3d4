(** * A motion in a cell of the sharp bound

    docs/sharp-bound.md, step 6: where a motion's tilt, |psi'| and p lie in cells,
    a cell of directions bounds |omega_d|^2 and |omega_d'|^2 with the functions of
    [SharpCells], for everything [Reachable] of controller-core/src/certificate/
    reachable.rs allows: m/s^2, m/s^3, m/s^4. *)

From Coq Require Import Reals Lra.
From SaturatedHybrid Require Import Space Direction DesiredFrame ExactRates Slope SharpBound SharpMotion SharpCells
  Partition.
Open Scope R_scope.

Section Motion.

Variables (u u_1 : R -> space) (psi psi_1 : R -> R) (t : R) (u_2 : space) (psi_2 : R).

(** [Reachable] of reachable.rs, and the reference's K_nu''. *)
Variables (vertical_least jerk horizontal_jerk vertical_jerk horizontal_snap vertical_snap : R).
Variable heading_second : R.
Hypothesis vertical_positive : 0 < vertical_least.
Hypothesis within_vertical : vertical_least <= z (u t).
Hypothesis within_jerk : length (u_1 t) <= jerk.
Hypothesis within_horizontal_jerk : plane_length (x (u_1 t)) (y (u_1 t)) <= horizontal_jerk.
Hypothesis within_vertical_jerk : Rabs (z (u_1 t)) <= vertical_jerk.
Hypothesis within_horizontal_snap : plane_length (x u_2) (y u_2) <= horizontal_snap.
Hypothesis within_vertical_snap : Rabs (z u_2) <= vertical_snap.
Hypothesis within_heading_second :
  psi_2 * psi_2 + psi_1 t * psi_1 t * psi_1 t * psi_1 t <= heading_second * heading_second.

Let upwards : 0 < z (u t). Proof. lra. Qed.
Let omega := omega u u_1 (nu psi) (nu_1 psi psi_1) t.
Let omega_1 := DesiredFrame.omega_1 u u_1 (nu psi) (nu_1 psi psi_1) t u_2 (nu_2 psi psi_1 t psi_2).
Let n := n u t.
Let cos_tilt := cos_tilt u t.
Let sin_tilt := sin_tilt u t.
Let p := tangential u t (u_1 t).

(** Its angle to the slope, and what follows for the part orthogonal to rho. *)
Lemma in_a_direction : forall v, exists a_cos a_sin, a_cos * a_cos + a_sin * a_sin = 1 /\
  let h := plane_length (x v) (y v) in
  tangential u t v * tangential u t v
  = h * h + z v * z v - (sin_tilt * h * a_cos + cos_tilt * z v) * (sin_tilt * h * a_cos + cos_tilt * z v) /\
  within_across u t v (h * Rabs a_sin).
Proof.
  intros v. set (h := plane_length (x v) (y v)).
  assert (Hslope : exists d_x d_y, d_x * d_x + d_y * d_y = 1 /\
    x (rho u t) = sin_tilt * d_x /\ y (rho u t) = sin_tilt * d_y).
  { unfold sin_tilt, SharpMotion.sin_tilt. change (direction (u t)) with (rho u t).
    pose proof (plane_length_squared (x (rho u t)) (y (rho u t))) as Hs.
    set (s := plane_length (x (rho u t)) (y (rho u t))) in *.
    pose proof (squared (x (rho u t))). pose proof (squared (y (rho u t))).
    destruct (Req_dec s 0) as [Hz|Hz].
    - exists 1, 0. rewrite Hz in *. split; [ring|].
      split; [destruct (Rmult_integral (x (rho u t)) (x (rho u t))) |
        destruct (Rmult_integral (y (rho u t)) (y (rho u t)))]; lra.
    - exists (x (rho u t) / s), (y (rho u t) / s). split; [|split; field; exact Hz].
      replace (x (rho u t) / s * (x (rho u t) / s) + y (rho u t) / s * (y (rho u t) / s))
        with ((x (rho u t) * x (rho u t) + y (rho u t) * y (rho u t)) / (s * s)) by (field; exact Hz).
      rewrite <- Hs. field. exact Hz. }
  destruct Hslope as (d_x & d_y & Hd & Hx & Hy).
  pose proof (plane_length_nonneg (x v) (y v)) as Hh0. pose proof (plane_length_squared (x v) (y v)) as Hh.
  fold h in Hh0, Hh.
  assert (Hangle : exists a_cos a_sin, a_cos * a_cos + a_sin * a_sin = 1 /\
    d_x * x v + d_y * y v = h * a_cos /\ d_y * x v - d_x * y v = h * a_sin).
  { pose proof (squared (x v)). pose proof (squared (y v)).
    destruct (Req_dec h 0) as [Hz|Hz].
    - exists 1, 0. rewrite Hz in *.
      assert (x v = 0) as -> by (destruct (Rmult_integral (x v) (x v)); lra).
      assert (y v = 0) as -> by (destruct (Rmult_integral (y v) (y v)); lra). repeat split; ring.
    - exists ((d_x * x v + d_y * y v) / h), ((d_y * x v - d_x * y v) / h). split; [|split; field; exact Hz].
      replace ((d_x * x v + d_y * y v) / h * ((d_x * x v + d_y * y v) / h)
               + (d_y * x v - d_x * y v) / h * ((d_y * x v - d_x * y v) / h))
        with ((d_x * d_x + d_y * d_y) * (x v * x v + y v * y v) / (h * h)) by (field; exact Hz).
      rewrite Hd, <- Hh. field. exact Hz. }
  destruct Hangle as (a_cos & a_sin & Ha & Hc & Hs). exists a_cos, a_sin. split; [exact Ha|]. split.
  - pose proof (budget_is_shared u t upwards v) as Hb.
    assert (Hrho : dot (rho u t) v = sin_tilt * h * a_cos + cos_tilt * z v).
    { unfold dot. rewrite Hx, Hy. unfold cos_tilt, SharpMotion.cos_tilt. change (direction (u t)) with (rho u t).
      transitivity (sin_tilt * (d_x * x v + d_y * y v) + z (rho u t) * z v); [ring | rewrite Hc; ring]. }
    rewrite Hrho in Hb. unfold square, dot in Hb. rewrite Hh. lra.
  - unfold within_across. rewrite Hx, Hy. fold sin_tilt.
    replace (sin_tilt * d_y * x v - sin_tilt * d_x * y v) with (sin_tilt * (d_y * x v - d_x * y v)) by ring.
    rewrite Hs, !Rabs_mult, (Rabs_pos_eq sin_tilt), (Rabs_pos_eq h); [lra | exact Hh0 | apply plane_length_nonneg].
Qed.

Section Cell.

(** A cell of the tilt, and what there is in it. *)
Variables (near far : R).
Hypothesis tilt_in_cell : 0 <= near /\ near <= tangent cos_tilt sin_tilt <= far.

Let on_circle : cos_tilt * cos_tilt + sin_tilt * sin_tilt = 1.
Proof. exact (tilt_on_circle u t upwards). Qed.
Let not_flat : 0 < cos_tilt /\ 0 <= sin_tilt.
Proof. split; [exact (proj2 (magnitude_of_tilt u t upwards)) | apply plane_length_nonneg]. Qed.

Let m := magnitude near vertical_least.

Lemma cell_facts : 0 < m /\ m <= n /\ 0 < / n <= / m /\ / cos_tilt <= secant far /\ 0 <= sin_tilt <= tilt_sin far.
Proof.
  destruct (SharpCells.tilt_in_cell near far vertical_least cos_tilt sin_tilt on_circle not_flat tilt_in_cell
    vertical_positive)
    as (H1 & H2 & _ & H4 & _ & H6). fold m in H4, H6.
  assert (Hmn : m <= n).
  { apply H6. pose proof (proj1 (magnitude_of_tilt u t upwards)) as E. fold n cos_tilt in E. lra. }
  split; [exact H4|]. split; [exact Hmn|]. split; [|split; [exact H1|split; [apply not_flat | lra]]].
  split; [apply Rinv_0_lt_compat; lra | apply Rinv_le_contravar; lra].
Qed.

(** A vector's part orthogonal to rho, over n. *)
Lemma vector_in_cell : forall v h vertical d_greatest d_least d_sin a_cos a_sin,
  plane_length (x v) (y v) <= h -> Rabs (z v) <= vertical ->
  a_cos * a_cos + a_sin * a_sin = 1 ->
  tangential u t v * tangential u t v
  = plane_length (x v) (y v) * plane_length (x v) (y v) + z v * z v
    - (sin_tilt * plane_length (x v) (y v) * a_cos + cos_tilt * z v)
      * (sin_tilt * plane_length (x v) (y v) * a_cos + cos_tilt * z v) ->
  0 <= d_least <= Rabs a_cos -> Rabs a_cos <= d_greatest -> Rabs a_sin <= d_sin ->
  0 <= tangential u t v / n <= tangential_length near far vertical_least h vertical d_greatest d_least /\
  0 <= (tangential u t v / n + plane_length (x v) (y v) * Rabs a_sin / n) / 2
    <= tangential_mixed near far vertical_least h vertical d_greatest d_least d_sin.
Proof.
  intros v h V dg dl ds a s Hh HV Ha Hsq Hdl Hdg Hds. destruct cell_facts as (Hm & Hmn & Hi & _).
  pose proof (plane_length_nonneg (x v) (y v)) as Hp0. pose proof (length_nonneg (across (u t) v)) as Ht0.
  fold (tangential u t v) in Ht0. pose proof (Rabs_pos s) as Hs0.
  assert (H : 0 <= tangential u t v / n <= tangential_length near far vertical_least h V dg dl).
  { split; [apply Rmult_le_pos; lra|]. unfold tangential_length. apply Rmult_le_compat; try lra; [|exact (proj2 Hi)].
    rewrite <- (sqrt_square (tangential u t v)) by exact Ht0. apply sqrt_le_1_alt. rewrite Hsq.
    apply (tangential_within near far vertical_least cos_tilt sin_tilt) with s; auto; lra. }
  split; [exact H|].
  assert (H2 : 0 <= plane_length (x v) (y v) * Rabs s / n <= h * ds / m).
  { unfold Rdiv. split; [repeat apply Rmult_le_pos; lra|].
    apply Rmult_le_compat; [now apply Rmult_le_pos | lra | apply Rmult_le_compat; lra | lra]. }
  unfold tangential_mixed. fold m. split; lra.
Qed.

(** omega_d. *)
Theorem velocity_in_cell : forall angles, (0 < angles)%nat -> exists k, (k < angles)%nat /\
  p <= tangential_length near far vertical_least horizontal_jerk vertical_jerk
         (cos (angle angles k)) (cos (angle angles (S k))) * m /\
  forall rate, Rabs (psi_1 t) <= rate ->
  square omega <= velocity_square far
    (tangential_length near far vertical_least horizontal_jerk vertical_jerk
      (cos (angle angles k)) (cos (angle angles (S k))))
    (tangential_mixed near far vertical_least horizontal_jerk vertical_jerk
      (cos (angle angles k)) (cos (angle angles (S k))) (sin (angle angles (S k)))) rate.
Proof.
  intros angles Hangles. destruct (in_a_direction (u_1 t)) as (a & s & Ha & Hsq & Hw). cbv zeta in Hsq, Hw.
  destruct (in_some_direction angles a s Hangles Ha) as (k & Hk & Hdl & Hdg & Hds).
  destruct (vector_in_cell _ _ _ _ _ _ _ _ within_horizontal_jerk within_vertical_jerk Ha Hsq Hdl Hdg Hds) as (L & X).
  destruct cell_facts as (Hm & Hmn & Hi & Hsec & Hsin). fold p in L, X.
  exists k. split; [exact Hk|]. split.
  { assert (Hp0 : 0 <= p) by apply length_nonneg.
    unfold tangential_length. fold m.
    replace (sqrt (tangential_square near far horizontal_jerk vertical_jerk (cos (angle angles k)) (cos (angle angles
      (S k)))) / m * m)
      with (sqrt (tangential_square near far horizontal_jerk vertical_jerk (cos (angle angles k)) (cos (angle angles
        (S k)))))
      by (field; lra).
    rewrite <- (sqrt_square p) by exact Hp0. apply sqrt_le_1_alt. unfold p. rewrite Hsq.
    apply (tangential_within near far vertical_least cos_tilt sin_tilt) with s; auto; try lra.
    split; [apply plane_length_nonneg | exact within_horizontal_jerk]. }
  intros rate Hrate.
  destruct (sharp_bound_of_motion u u_1 psi psi_1 t u_2 psi_2 upwards
    _ _ Hw (horizontal_is_across u t u_2)) as (H & _). cbv zeta in H.
  eapply Rle_trans; [exact H|]. fold p n cos_tilt sin_tilt.
  pose proof (Rabs_pos (psi_1 t)). assert (Hc : 0 < / cos_tilt) by (apply Rinv_0_lt_compat; lra).
  assert (Htan : 0 <= tangent cos_tilt sin_tilt <= far) by lra.
  assert (Y := yaw_bound_grows (tangent cos_tilt sin_tilt) far (/ cos_tilt) (secant far) (Rabs (psi_1 t)) rate
    _ _ Htan (conj (Rlt_le _ _ Hc) Hsec) (conj (Rabs_pos (psi_1 t)) Hrate) X).
  unfold velocity_square. apply Rplus_le_compat; apply squares_below; lra.
Qed.

(** omega_d', for |psi'| and p in cells of their own. *)
Theorem acceleration_in_cell : forall angles near_rate far_rate least most, (0 < angles)%nat ->
  0 <= near_rate <= Rabs (psi_1 t) -> Rabs (psi_1 t) <= far_rate ->
  0 <= least <= p -> p <= most ->
  exists k, (k < angles)%nat /\
  square omega_1 <= acceleration_square near far vertical_least
    (tangential_length near far vertical_least horizontal_snap vertical_snap
      (cos (angle angles k)) (cos (angle angles (S k))))
    (tangential_mixed near far vertical_least horizontal_snap vertical_snap
      (cos (angle angles k)) (cos (angle angles (S k))) (sin (angle angles (S k))))
    far_rate (heading_acceleration heading_second near_rate) jerk horizontal_jerk least most.
Proof.
  intros angles near_rate far_rate least most Hangles Hnear Hfar Hleast Hmost.
  destruct (in_a_direction u_2) as (a & s & Ha & Hsq & Hw). cbv zeta in Hsq, Hw.
  destruct (in_some_direction angles a s Hangles Ha) as (k & Hk & Hdl & Hdg & Hds).
  destruct (vector_in_cell _ _ _ _ _ _ _ _ within_horizontal_snap within_vertical_snap Ha Hsq Hdl Hdg Hds) as (L & X).
  destruct cell_facts as (Hm & Hmn & Hi & Hsec & Hsin). exists k. split; [exact Hk|].
  (* the lesser of p and the horizontal part of u' *)
  assert (Hperp : within_across u t (u_1 t) (Rmin p horizontal_jerk)).
  { unfold Rmin. destruct (Rle_dec p horizontal_jerk); [apply tangential_is_across|].
    unfold within_across. eapply Rle_trans; [apply (horizontal_is_across u t (u_1 t))|].
    apply Rmult_le_compat_l; [apply plane_length_nonneg | exact within_horizontal_jerk]. }
  destruct (sharp_bound_of_motion u u_1 psi psi_1 t u_2 psi_2 upwards
    _ _ Hperp Hw) as (_ & H). cbv zeta in H. fold p n cos_tilt sin_tilt in H.
  eapply Rle_trans; [exact H|]. clear H.
  pose proof (Rabs_pos (psi_1 t)) as Hr0. assert (Hc : 0 < / cos_tilt) by (apply Rinv_0_lt_compat; lra).
  assert (Htan : 0 <= tangent cos_tilt sin_tilt <= far) by lra.
  pose proof (conj (Rlt_le _ _ Hc) Hsec) as Hsecant.
  pose proof (conj Hr0 Hfar) as Hrate.
  assert (Hp0 : 0 <= p) by apply length_nonneg.
  assert (Hlength : 0 <= p / n <= most / m).
  { split; [apply Rmult_le_pos; lra | apply Rmult_le_compat; lra]. }
  set (r := Rabs (radial u u_1 t)) in *. assert (Hrr0 : 0 <= r) by apply Rabs_pos.
  assert (Hbudget : p * p + r * r <= jerk * jerk).
  { pose proof (budget_is_shared u t upwards (u_1 t)) as E. fold p in E.
    assert (Er : r * r = dot (rho u t) (u_1 t) * dot (rho u t) (u_1 t)).
    { unfold r. rewrite <- Rabs_mult. apply Rabs_pos_eq, squared. }
    rewrite Er, E. now apply square_below. }
  assert (Hll : least * least <= p * p <= most * most) by (split; apply squares_below; lra).
  assert (Hstretch : 0 <= r / n <= share_stretch near vertical_least jerk least).
  { split; [apply Rmult_le_pos; lra|]. unfold share_stretch. fold m. apply Rmult_le_compat; try lra.
    rewrite <- (sqrt_square r) by exact Hrr0. apply sqrt_le_1_alt. lra. }
  assert (Hproduct : 0 <= p / n * (r / n) <= share_product near vertical_least jerk least most).
  { split; [apply Rmult_le_pos; [apply Hlength | apply Hstretch]|]. unfold share_product. fold m.
    assert (Hgp : p * r <= greatest_product (jerk * jerk) (least * least) (most * most)).
    { pose proof (squared p). pose proof (squared r). eapply Rle_trans; [|apply (product_within _ _ _ (p * p)); lra].
      rewrite <- (sqrt_square (p * r)) by (now apply Rmult_le_pos). apply sqrt_le_1_alt.
      replace (p * r * (p * r)) with (p * p * (r * r)) by ring. apply Rmult_le_compat_l; lra. }
    assert (Hii : 0 <= / n * / n <= / (m * m)).
    { rewrite Rinv_mult. split; [apply squared | apply squares_below; lra]. }
    replace (p / n * (r / n)) with (p * r * (/ n * / n)) by (field; lra). unfold Rdiv.
    apply Rmult_le_compat; try lra. now apply Rmult_le_pos. }
  assert (Hmixed : 0 <= (p / n + Rmin p horizontal_jerk / n) / 2 <= share_mixed near vertical_least horizontal_jerk
    most).
  { assert (Hh0 : 0 <= horizontal_jerk) by (eapply Rle_trans; [apply plane_length_nonneg |
    exact within_horizontal_jerk]).
    assert (Hmin : 0 <= Rmin p horizontal_jerk <= Rmin most horizontal_jerk).
    { split; [apply Rmin_glb; lra|]. apply Rmin_glb; [eapply Rle_trans; [apply Rmin_l | lra] | apply Rmin_r]. }
    assert (H : 0 <= Rmin p horizontal_jerk / n <= Rmin most horizontal_jerk / m).
    { split; [apply Rmult_le_pos; lra | apply Rmult_le_compat; lra]. }
    unfold share_mixed. fold m. lra. }
  assert (Hacceleration : 0 <= Rabs psi_2 <= heading_acceleration heading_second near_rate).
  { split; [apply Rabs_pos|]. unfold heading_acceleration. rewrite <- (sqrt_square (Rabs psi_2)) by apply Rabs_pos.
    apply sqrt_le_1_alt. rewrite <- Rabs_mult, Rabs_pos_eq by apply squared.
    assert (Hq : near_rate * near_rate <= psi_1 t * psi_1 t).
    { replace (psi_1 t * psi_1 t) with (Rabs (psi_1 t) * Rabs (psi_1 t)) by (rewrite <- Rabs_mult;
      apply Rabs_pos_eq, squared).
      apply squares_below; lra. }
    pose proof (squares_below _ _ (squared near_rate) Hq). lra. }
  pose proof (tilting_bound_grows _ _ _ _ _ _ _ _ _ _ _ _ Htan Hsecant Hrate Hlength Hproduct Hmixed) as T.
  pose proof (yawing_bound_grows _ _ _ _ _ _ _ _ _ _ _ _ _ _ _ _ Htan Hsin Hsecant Hrate Hacceleration Hstretch
    Hlength Hmixed) as Y.
  unfold acceleration_square, square_of_sum. fold m.
  assert (Hlin : 0 <= tangent cos_tilt sin_tilt * ((tangential u t u_2 / n + plane_length (x u_2) (y u_2) * Rabs s /
    n) / 2)
    <= far * tangential_mixed near far vertical_least horizontal_snap vertical_snap
      (cos (angle angles k)) (cos (angle angles (S k))) (sin (angle angles (S k)))).
  { split; [apply Rmult_le_pos; lra | apply Rmult_le_compat; lra]. }
  apply Rplus_le_compat; apply squares_below; lra.
Qed.

End Cell.

End Motion.
