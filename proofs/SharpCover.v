(** * The cells of the sharp bound cover everything

    docs/sharp-bound.md, step 6; [desired_rates] in controller-core/src/
    certificate/sharp.rs: whatever the filters, the reference and the heading do
    within their bounds, some cell's bound is above |omega_d|^2 and |omega_d'|^2.
    The greatest over the cells is so a bound. Exact arithmetic: what rounding
    does to the cells is not here. *)

From Coq Require Import Reals Lra.
From SaturatedHybrid Require Import Space Direction DesiredFrame ExactRates Slope SharpBound SharpMotion SharpCells
  Partition SharpInCell.
Open Scope R_scope.

Section Motion.

Variables (u u_1 : R -> space) (psi psi_1 : R -> R) (t : R) (u_2 : space) (psi_2 : R).

(** [Reachable] of reachable.rs, and the reference's K_nu' and K_nu''. *)
Variables (vertical_least horizontal jerk horizontal_jerk vertical_jerk horizontal_snap vertical_snap : R).
Variables (heading_rate heading_second : R).
Hypothesis vertical_positive : 0 < vertical_least.
Hypothesis within_vertical : vertical_least <= z (u t).
Hypothesis within_horizontal : plane_length (x (u t)) (y (u t)) <= horizontal.
Hypothesis within_jerk : length (u_1 t) <= jerk.
Hypothesis within_horizontal_jerk : plane_length (x (u_1 t)) (y (u_1 t)) <= horizontal_jerk.
Hypothesis within_vertical_jerk : Rabs (z (u_1 t)) <= vertical_jerk.
Hypothesis within_horizontal_snap : plane_length (x u_2) (y u_2) <= horizontal_snap.
Hypothesis within_vertical_snap : Rabs (z u_2) <= vertical_snap.
Hypothesis within_heading_rate : Rabs (psi_1 t) <= heading_rate.
Hypothesis heading_second_nonneg : 0 <= heading_second.
Hypothesis within_heading_second :
  psi_2 * psi_2 + psi_1 t * psi_1 t * psi_1 t * psi_1 t <= heading_second * heading_second.

Let upwards : 0 < z (u t). Proof. lra. Qed.
Let omega := omega u u_1 (nu psi) (nu_1 psi psi_1) t.
Let omega_1 := DesiredFrame.omega_1 u u_1 (nu psi) (nu_1 psi psi_1) t u_2 (nu_2 psi psi_1 t psi_2).
Let n := n u t.
Let cos_tilt := cos_tilt u t.
Let sin_tilt := sin_tilt u t.
Let p := tangential u t (u_1 t).

Definition steepest : R := horizontal / vertical_least.
Definition fastest : R := Rmin heading_rate (sqrt heading_second).

Lemma tilt_within : 0 <= tangent cos_tilt sin_tilt <= steepest.
Proof.
  destruct (magnitude_of_tilt u t upwards) as (E & Hc). fold n cos_tilt in E, Hc.
  assert (Hn : 0 < n) by (exact (n_positive u t upwards)).
  assert (Hs0 : 0 <= sin_tilt) by apply plane_length_nonneg.
  assert (Hs : n * sin_tilt = plane_length (x (u t)) (y (u t))).
  { assert (E1 : forall a, / length (u t) * a = a / n) by (intros a; unfold n, SharpMotion.n, Rdiv; ring).
    unfold sin_tilt, SharpMotion.sin_tilt, direction. cbn [x y scaled]. rewrite !E1.
    rewrite plane_length_over by exact Hn. field. lra. }
  unfold tangent, steepest. split; [apply Rmult_le_pos; [exact Hs0 | left; now apply Rinv_0_lt_compat]|].
  replace (sin_tilt / cos_tilt) with (n * sin_tilt / (n * cos_tilt)) by (field; lra).
  rewrite Hs, E. apply Rmult_le_compat; [apply plane_length_nonneg | left; apply Rinv_0_lt_compat; lra |
    exact within_horizontal |].
  apply Rinv_le_contravar; lra.
Qed.

Lemma rate_within : Rabs (psi_1 t) <= fastest.
Proof.
  unfold fastest. apply Rmin_glb; [exact within_heading_rate|].
  rewrite <- (sqrt_square (Rabs (psi_1 t))) by apply Rabs_pos. apply sqrt_le_1_alt.
  rewrite <- Rabs_mult, Rabs_pos_eq by apply squared. apply below_by_squares; [exact heading_second_nonneg|].
  pose proof (squared psi_2). lra.
Qed.

(** Some cell's bound is above. [longest i]: what p is at most in the cell i of
    the tilt; the code's is the least that is allowed here. Both results are for
    one cell of the tilt, as the torque's are. *)
Definition covered (tilts angles splits headings : nat) (longest : nat -> R) : Prop :=
  let near i := end_of steepest tilts i in let far i := end_of steepest tilts (S i) in
  let cosine k := cos (angle angles k) in let sine k := sin (angle angles k) in
  let length i k h v := tangential_length (near i) (far i) vertical_least h v (cosine k) (cosine (S k)) in
  let mixed i k h v := tangential_mixed (near i) (far i) vertical_least h v (cosine k) (cosine (S k)) (sine (S k)) in
  (forall i q, (i < tilts)%nat -> q <= jerk ->
     (exists k, (k < angles)%nat /\ q <= length i k horizontal_jerk vertical_jerk * magnitude (near i)
       vertical_least) ->
     q <= longest i) ->
  exists i, (i < tilts)%nat /\
  (exists k, (k < angles)%nat /\
     square omega <= velocity_square (far i)
       (length i k horizontal_jerk vertical_jerk) (mixed i k horizontal_jerk vertical_jerk) fastest) /\
  (exists k l j, (k < angles)%nat /\ (l < splits)%nat /\ (j < headings)%nat /\
     square omega_1 <= acceleration_square (near i) (far i) vertical_least
       (length i k horizontal_snap vertical_snap) (mixed i k horizontal_snap vertical_snap)
       (end_of fastest headings (S j)) (heading_acceleration heading_second (end_of fastest headings j))
       jerk horizontal_jerk (end_of (longest i) splits l) (end_of (longest i) splits (S l))).

Theorem sharp_bound_covers : forall tilts angles splits headings longest,
  (0 < tilts)%nat -> (0 < angles)%nat -> (0 < splits)%nat -> (0 < headings)%nat ->
  covered tilts angles splits headings longest.
Proof.
  intros tilts angles splits headings longest Htilts Hangles Hsplits Hheadings. cbv beta delta [covered].
  intros near far cosine sine length mixed Hlongest.
  destruct (in_some_cell tilts steepest _ Htilts tilt_within) as (i & Hi & Hlow & Hhigh).
  exists i. split; [exact Hi|].
  assert (Hcell : 0 <= near i /\ near i <= tangent cos_tilt sin_tilt <= far i) by (unfold near, far; lra).
  destruct (velocity_in_cell u u_1 psi psi_1 t u_2 psi_2 _ _ _
    vertical_positive within_vertical within_horizontal_jerk within_vertical_jerk _ _ Hcell angles Hangles)
    as (k & Hk & Hp & Hv).
  split; [exists k; split; [exact Hk | apply Hv, rate_within]|].
  assert (Hp0 : 0 <= p <= longest i).
  { split; [apply length_nonneg|]. apply Hlongest; [exact Hi | | exists k; split; [exact Hk | exact Hp]].
    eapply Rle_trans; [apply across_shorter; exact (n_positive u t upwards) | exact within_jerk]. }
  destruct (in_some_cell splits _ _ Hsplits Hp0) as (l & Hl & Hleast & Hmost).
  destruct (in_some_cell headings fastest _ Hheadings (conj (Rabs_pos (psi_1 t)) rate_within)) as (j & Hj & Hnear &
    Hfar).
  destruct (acceleration_in_cell u u_1 psi psi_1 t u_2 psi_2 _ _ _ _ _ _
    vertical_positive within_vertical within_jerk within_horizontal_jerk within_horizontal_snap within_vertical_snap
    within_heading_second _ _ Hcell angles _ _ _ _ Hangles Hnear Hfar Hleast Hmost) as (k' & Hk' & Ha).
  exists k', l, j. repeat split; assumption.
Qed.

End Motion.
