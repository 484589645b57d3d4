(** * The attitude law: levels, descent, jumps, equilibria

    Section 6 of docs/extended-law.md, in exact arithmetic and continuous
    time; controller-core/src/extended/attitude.rs. *)

From Coq Require Import Reals Lra.
Open Scope R_scope.

Lemma squared : forall x, 0 <= x * x.
Proof. intros x. apply Rle_0_sqr. Qed.

(** ** The potential and its slope *)

Section Potential.

(** w, eta, M_t, k_t, eta_t. *)
Variables (w eta M_t k_t eta_t : R).
Hypothesis w_positive : 0 < w.
Hypothesis eta_between : 0 < eta < 1.
Hypothesis M_t_positive : 0 < M_t.
Hypothesis k_t_positive : 0 < k_t.
Hypothesis eta_t_positive : 0 < eta_t.

(** h. *)
Definition distance (q_0 q_3 : R) : R := sqrt ((q_0 + eta) * (q_0 + eta) + q_3 * q_3).

(** G of r^2, with 1 - r^2 as q_0^2 + q_3^2. *)
Definition slope (r_square rest : R) : R :=
  M_t * k_t / (sqrt (M_t * M_t + k_t * k_t * r_square) * sqrt (rest + eta_t * eta_t)).

(** P, in the code's form. *)
Definition P_1 (q_0 q_1 q_2 q_3 : R) : R :=
  w / (2 * distance q_0 q_3) * ((q_0 + eta) * q_1 + q_2 * q_3)
  + slope (q_1 * q_1 + q_2 * q_2) (q_0 * q_0 + q_3 * q_3) * (q_0 * q_1 + q_2 * q_3).
Definition P_2 (q_0 q_1 q_2 q_3 : R) : R :=
  w / (2 * distance q_0 q_3) * ((q_0 + eta) * q_2 - q_1 * q_3)
  + slope (q_1 * q_1 + q_2 * q_2) (q_0 * q_0 + q_3 * q_3) * (q_0 * q_2 - q_1 * q_3).
Definition P_3 (q_0 q_3 : R) : R := w / (2 * distance q_0 q_3) * (eta * q_3).

Lemma distance_squared : forall q_0 q_3,
  distance q_0 q_3 * distance q_0 q_3 = (q_0 + eta) * (q_0 + eta) + q_3 * q_3.
Proof.
  intros q_0 q_3. apply sqrt_def. pose proof (squared (q_0 + eta)). pose proof (squared q_3). lra.
Qed.

(** The lift keeps q_0 above -q_bar, and row E has q_bar < eta. *)
Lemma distance_positive : forall q_0 q_3, 0 < q_0 + eta -> 0 < distance q_0 q_3.
Proof.
  intros q_0 q_3 H. apply sqrt_lt_R0.
  assert (0 < (q_0 + eta) * (q_0 + eta)) by (now apply Rmult_lt_0_compat). pose proof (squared q_3). lra.
Qed.

Lemma slope_positive : forall r_square rest, 0 <= r_square -> 0 <= rest -> 0 < slope r_square rest.
Proof.
  intros r_square rest Hr Hrest. unfold slope. apply Rmult_lt_0_compat; [nra|].
  assert (0 < eta_t * eta_t) by nra. assert (0 < M_t * M_t) by nra.
  assert (0 <= k_t * k_t * r_square) by (apply Rmult_le_pos; nra).
  apply Rinv_0_lt_compat, Rmult_lt_0_compat; apply sqrt_lt_R0; lra.
Qed.

(** *** Levels *)

(** Yaw's feedback from the potential: at most w eta / 2. *)
Theorem yaw_level : forall q_0 q_3, 0 < q_0 + eta -> Rabs (P_3 q_0 q_3) <= w * eta / 2.
Proof.
  intros q_0 q_3 H. pose proof (distance_positive q_0 q_3 H) as Hd.
  assert (Hq : Rabs q_3 <= distance q_0 q_3).
  { rewrite <- sqrt_Rsqr_abs. apply sqrt_le_1_alt. unfold Rsqr. nra. }
  unfold P_3.
  replace (w / (2 * distance q_0 q_3) * (eta * q_3)) with (w * eta / 2 * (q_3 / distance q_0 q_3)) by (field; lra).
  assert (0 < w * eta) by nra.
  rewrite Rabs_mult, (Rabs_pos_eq (w * eta / 2)) by lra.
  rewrite <- (Rmult_1_r (w * eta / 2)) at 2. apply Rmult_le_compat_l; [lra|].
  unfold Rdiv. rewrite Rabs_mult, (Rabs_pos_eq (/ _)) by (left; now apply Rinv_0_lt_compat).
  apply Rmult_le_reg_r with (distance q_0 q_3); [exact Hd|].
  rewrite Rmult_assoc, Rinv_l by lra. lra.
Qed.

(** Two vectors across, and the length of their sum. *)
Lemma plane_triangle : forall a_1 a_2 c_1 c_2 a c, 0 <= a -> 0 <= c ->
  a_1 * a_1 + a_2 * a_2 = a * a -> c_1 * c_1 + c_2 * c_2 = c * c ->
  sqrt ((a_1 + c_1) * (a_1 + c_1) + (a_2 + c_2) * (a_2 + c_2)) <= a + c.
Proof.
  intros a_1 a_2 c_1 c_2 a c Ha Hc Haa Hcc.
  assert (Hcs : a_1 * c_1 + a_2 * c_2 <= a * c).
  { apply Rsqr_incr_0_var; [|now apply Rmult_le_pos]. unfold Rsqr.
    replace (a * c * (a * c)) with ((a * a) * (c * c)) by ring. rewrite <- Haa, <- Hcc.
    pose proof (Rle_0_sqr (a_1 * c_2 - a_2 * c_1)) as Hq. unfold Rsqr in Hq. lra. }
  rewrite <- (sqrt_square (a + c)) by lra. apply sqrt_le_1_alt. lra.
Qed.

(** The tilt's: |P| <= (w/2) r + G r sqrt (1 - r^2). *)
Theorem tilt_level : forall q_0 q_1 q_2 q_3, 0 < q_0 + eta ->
  let r := sqrt (q_1 * q_1 + q_2 * q_2) in
  let rest := q_0 * q_0 + q_3 * q_3 in
  sqrt (P_1 q_0 q_1 q_2 q_3 * P_1 q_0 q_1 q_2 q_3 + P_2 q_0 q_1 q_2 q_3 * P_2 q_0 q_1 q_2 q_3)
  <= w / 2 * r + slope (q_1 * q_1 + q_2 * q_2) rest * (r * sqrt rest).
Proof.
  intros q_0 q_1 q_2 q_3 H r rest.
  pose proof (distance_positive q_0 q_3 H) as Hd.
  pose proof (distance_squared q_0 q_3) as Hdd.
  assert (Hr : r * r = q_1 * q_1 + q_2 * q_2) by (apply sqrt_def; nra).
  assert (Hrest : sqrt rest * sqrt rest = rest) by (apply sqrt_def; unfold rest; nra).
  assert (Hr0 : 0 <= r) by apply sqrt_pos.
  pose proof (sqrt_pos rest) as Hs0.
  assert (HG : 0 < slope (q_1 * q_1 + q_2 * q_2) rest) by (apply slope_positive; unfold rest; nra).
  unfold P_1, P_2. fold rest.
  generalize dependent (slope (q_1 * q_1 + q_2 * q_2) rest). intros G HG.
  apply plane_triangle.
  - apply Rmult_le_pos; lra.
  - apply Rmult_le_pos; [lra | now apply Rmult_le_pos].
  - replace (w / 2 * r * (w / 2 * r)) with (w * w / 4 * (r * r)) by field. rewrite Hr.
    generalize dependent (distance q_0 q_3). intros h Hh Hhh.
    transitivity (w * w / (4 * (h * h)) * (((q_0 + eta) * (q_0 + eta) + q_3 * q_3) * (q_1 * q_1 + q_2 * q_2))).
    { field. lra. }
    rewrite <- Hhh. field. lra.
  - replace (G * (r * sqrt rest) * (G * (r * sqrt rest)))
      with (G * G * ((r * r) * (sqrt rest * sqrt rest))) by ring.
    rewrite Hr, Hrest. unfold rest. ring.
Qed.

(** *** Row D: the tilt's level over cells of r *)

(** The level of the cell from [near] to [far], each term at the end where it
    is greatest: [greatest_potential] of the certificate. *)
Definition cell (near far : R) : R :=
  w / 2 * far
  + M_t * k_t * far / sqrt (M_t * M_t + k_t * k_t * (far * far))
    * (sqrt (1 - near * near) / sqrt (1 - near * near + eta_t * eta_t)).

(** a / sqrt (c + a^2) rises with a. *)
Lemma ratio_rises : forall a b c, 0 < c -> 0 <= a <= b ->
  a / sqrt (c + a * a) <= b / sqrt (c + b * b).
Proof.
  intros a b c Hc Hab.
  assert (Ha : 0 < sqrt (c + a * a)) by (apply sqrt_lt_R0; pose proof (squared a); lra).
  assert (Hb : 0 < sqrt (c + b * b)) by (apply sqrt_lt_R0; pose proof (squared b); lra).
  assert (Haa : sqrt (c + a * a) * sqrt (c + a * a) = c + a * a) by (apply sqrt_def; pose proof (squared a); lra).
  assert (Hbb : sqrt (c + b * b) * sqrt (c + b * b) = c + b * b) by (apply sqrt_def; pose proof (squared b); lra).
  assert (Hsq : a * a <= b * b) by (apply Rmult_le_compat; lra).
  assert (Hcross : a * sqrt (c + b * b) <= b * sqrt (c + a * a)).
  { apply Rsqr_incr_0_var; [|apply Rmult_le_pos; lra]. unfold Rsqr.
    replace (a * sqrt (c + b * b) * (a * sqrt (c + b * b))) with (a * a * (sqrt (c + b * b) * sqrt (c + b * b))) by
      ring.
    replace (b * sqrt (c + a * a) * (b * sqrt (c + a * a))) with (b * b * (sqrt (c + a * a) * sqrt (c + a * a))) by
      ring.
    rewrite Haa, Hbb.
    assert (a * a * c <= b * b * c) by (apply Rmult_le_compat_r; lra). lra. }
  apply Rmult_le_reg_r with (sqrt (c + a * a) * sqrt (c + b * b)); [now apply Rmult_lt_0_compat|].
  replace (a / sqrt (c + a * a) * (sqrt (c + a * a) * sqrt (c + b * b))) with (a * sqrt (c + b * b)) by (field; lra).
  replace (b / sqrt (c + b * b) * (sqrt (c + a * a) * sqrt (c + b * b))) with (b * sqrt (c + a * a)) by (field; lra).
  exact Hcross.
Qed.

Theorem level_in_a_cell : forall near r far, 0 <= near <= r -> r <= far -> r <= 1 ->
  w / 2 * r + slope (r * r) (1 - r * r) * (r * sqrt (1 - r * r)) <= cell near far.
Proof.
  intros near r far Hnear Hfar H1.
  assert (Hrr : r * r <= 1) by (rewrite <- (Rmult_1_r 1); apply Rmult_le_compat; lra).
  assert (Hnn : near * near <= r * r) by (apply Rmult_le_compat; lra).
  assert (He : 0 < eta_t * eta_t) by (now apply Rmult_lt_0_compat).
  assert (HM : 0 < M_t * M_t) by (now apply Rmult_lt_0_compat).
  set (rest := sqrt (1 - r * r)). set (rest_near := sqrt (1 - near * near)).
  assert (Hrest : rest * rest = 1 - r * r) by (apply sqrt_def; lra).
  assert (Hrest_near : rest_near * rest_near = 1 - near * near) by (apply sqrt_def; lra).
  assert (Hpos : 0 <= rest) by apply sqrt_pos.
  assert (Hless : rest <= rest_near) by (apply sqrt_le_1_alt; lra).
  pose proof (ratio_rises rest rest_near (eta_t * eta_t) He ltac:(lra)) as Hfall.
  rewrite Hrest, Hrest_near, !(Rplus_comm (eta_t * eta_t)) in Hfall.
  pose proof (ratio_rises (k_t * r) (k_t * far) (M_t * M_t) HM
    ltac:(split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra)) as Hrise.
  replace (k_t * r * (k_t * r)) with (k_t * k_t * (r * r)) in Hrise by ring.
  replace (k_t * far * (k_t * far)) with (k_t * k_t * (far * far)) in Hrise by ring.
  assert (Hsr : 0 < sqrt (M_t * M_t + k_t * k_t * (r * r))).
  { apply sqrt_lt_R0. assert (0 <= k_t * k_t * (r * r)) by (apply Rmult_le_pos; apply squared). lra. }
  assert (Hse : 0 < sqrt (1 - r * r + eta_t * eta_t)) by (apply sqrt_lt_R0; lra).
  unfold cell, slope. fold rest_near. fold rest in Hfall. fold rest_near in Hfall.
  set (a := k_t * r / sqrt (M_t * M_t + k_t * k_t * (r * r))) in *.
  set (b := k_t * far / sqrt (M_t * M_t + k_t * k_t * (far * far))) in *.
  set (c := rest / sqrt (1 - r * r + eta_t * eta_t)) in *.
  set (d := rest_near / sqrt (1 - near * near + eta_t * eta_t)) in *.
  replace (M_t * k_t / (sqrt (M_t * M_t + k_t * k_t * (r * r)) * sqrt (1 - r * r + eta_t * eta_t)) * (r * rest))
    with (M_t * (a * c)) by (unfold a, c; field; lra).
  replace (M_t * k_t * far / sqrt (M_t * M_t + k_t * k_t * (far * far)) * d) with (M_t * (b * d))
    by (unfold b; unfold Rdiv; ring).
  assert (Ha : 0 <= a).
  { unfold a. apply Rmult_le_pos; [apply Rmult_le_pos; lra | left; now apply Rinv_0_lt_compat]. }
  assert (Hc : 0 <= c).
  { unfold c. apply Rmult_le_pos; [exact Hpos | left; now apply Rinv_0_lt_compat]. }
  assert (a * c <= b * d) by (apply Rmult_le_compat; assumption).
  assert (M_t * (a * c) <= M_t * (b * d)) by (apply Rmult_le_compat_l; lra).
  assert (w / 2 * r <= w / 2 * far) by (apply Rmult_le_compat_l; lra). lra.
Qed.

(** *** Equilibria: rows E *)

(** G r is at most M_t / eta_t. *)
Lemma slope_bound : forall r r_square rest, 0 < r -> r * r = r_square -> 0 <= rest ->
  slope r_square rest * r <= M_t / eta_t.
Proof.
  intros r r_square rest Hr <- Hrest. unfold slope.
  assert (Hkr : 0 < k_t * r) by nra.
  assert (H1 : k_t * r <= sqrt (M_t * M_t + k_t * k_t * (r * r))).
  { rewrite <- (sqrt_square (k_t * r)) at 1 by lra. apply sqrt_le_1_alt. nra. }
  assert (H2 : eta_t <= sqrt (rest + eta_t * eta_t)).
  { rewrite <- (sqrt_square eta_t) at 1 by lra. apply sqrt_le_1_alt. lra. }
  generalize dependent (sqrt (M_t * M_t + k_t * k_t * (r * r))). intros a Ha.
  generalize dependent (sqrt (rest + eta_t * eta_t)). intros c Hc.
  assert (0 < a) by lra. assert (0 < c) by lra.
  assert (Hac : 0 < a * c) by nra.
  apply Rmult_le_reg_r with (a * c * eta_t); [nra|].
  replace (M_t * k_t / (a * c) * r * (a * c * eta_t)) with (M_t * (k_t * r * eta_t)) by (field; lra).
  replace (M_t / eta_t * (a * c * eta_t)) with (M_t * (a * c)) by (field; lra).
  apply Rmult_le_compat_l; [lra|]. apply Rmult_le_compat; lra.
Qed.

(** Without torque there is no error: no equilibrium but the target. *)
Theorem only_the_target : forall q_bar q_0 q_1 q_2 q_3,
  q_0 * q_0 + q_1 * q_1 + q_2 * q_2 + q_3 * q_3 = 1 ->
  0 <= q_bar < eta -> - q_bar <= q_0 ->
  2 * q_bar * M_t < w * eta_t * sqrt (1 - q_bar * q_bar) ->
  P_1 q_0 q_1 q_2 q_3 = 0 -> P_2 q_0 q_1 q_2 q_3 = 0 -> P_3 q_0 q_3 = 0 ->
  q_1 = 0 /\ q_2 = 0 /\ q_3 = 0.
Proof.
  intros q_bar q_0 q_1 q_2 q_3 Hunit Hbar Hq0 Hrow H1 H2 H3.
  assert (Hpos : 0 < q_0 + eta) by lra.
  pose proof (distance_positive q_0 q_3 Hpos) as Hd.
  assert (Hz : q_3 = 0).
  { unfold P_3 in H3. apply Rmult_integral in H3. destruct H3 as [H3|H3].
    - assert (0 < w / (2 * distance q_0 q_3)) by (apply Rmult_lt_0_compat; [lra | apply Rinv_0_lt_compat; lra]). lra.
    - apply Rmult_integral in H3. destruct H3; lra. }
  subst q_3.
  assert (Hdist : distance q_0 0 = q_0 + eta).
  { unfold distance. replace ((q_0 + eta) * (q_0 + eta) + 0 * 0) with ((q_0 + eta) * (q_0 + eta)) by ring.
    apply sqrt_square. lra. }
  unfold P_1 in H1. unfold P_2 in H2. rewrite Hdist in H1, H2.
  destruct (Rle_lt_or_eq_dec 0 (q_1 * q_1 + q_2 * q_2) ltac:(nra)) as [Hr|Hr].
  2: { assert (Hs : Rsqr q_1 + Rsqr q_2 = 0) by (unfold Rsqr; lra).
       destruct (Rplus_sqr_eq_0 q_1 q_2 Hs). repeat split; assumption. }
  exfalso.
  set (r := sqrt (q_1 * q_1 + q_2 * q_2)).
  assert (Hrr : r * r = q_1 * q_1 + q_2 * q_2) by (apply sqrt_def; lra).
  assert (Hr0 : 0 < r) by (now apply sqrt_lt_R0).
  assert (HG : 0 < slope (q_1 * q_1 + q_2 * q_2) (q_0 * q_0 + 0 * 0)) by (apply slope_positive; nra).
  pose proof (slope_bound r (q_1 * q_1 + q_2 * q_2) (q_0 * q_0 + 0 * 0) Hr0 Hrr ltac:(nra)) as Hbound.
  generalize dependent (slope (q_1 * q_1 + q_2 * q_2) (q_0 * q_0 + 0 * 0)). intros G H1 H2 HG Hbound.
  assert (Hsum : w / 2 + G * q_0 = 0).
  { apply Rmult_eq_reg_r with (q_1 * q_1 + q_2 * q_2); [|lra]. rewrite Rmult_0_l.
    transitivity (q_1 * (w / (2 * (q_0 + eta)) * ((q_0 + eta) * q_1 + q_2 * 0) + G * (q_0 * q_1 + q_2 * 0))
          + q_2 * (w / (2 * (q_0 + eta)) * ((q_0 + eta) * q_2 - q_1 * 0) + G * (q_0 * q_2 - q_1 * 0))).
    - field. lra.
    - rewrite H1, H2. ring. }
  assert (Hneg : q_0 < 0).
  { apply Rnot_le_lt. intros Hge. assert (0 <= G * q_0) by (apply Rmult_le_pos; lra). lra. }
  assert (Hcos : sqrt (1 - q_bar * q_bar) <= r).
  { apply sqrt_le_1_alt. assert (q_0 * q_0 <= q_bar * q_bar) by nra. lra. }
  assert (Hhalf : w / 2 <= G * q_bar).
  { assert (G * - q_0 <= G * q_bar) by (apply Rmult_le_compat_l; lra). lra. }
  assert (Hlow : w / 2 * sqrt (1 - q_bar * q_bar) <= M_t / eta_t * q_bar).
  { apply Rle_trans with (w / 2 * r); [apply Rmult_le_compat_l; lra|].
    apply Rle_trans with (G * q_bar * r); [apply Rmult_le_compat_r; lra|].
    replace (G * q_bar * r) with (G * r * q_bar) by ring. apply Rmult_le_compat_r; lra. }
  apply Rmult_le_compat_l with (r := 2 * eta_t) in Hlow; [|lra].
  replace (2 * eta_t * (M_t / eta_t * q_bar)) with (2 * q_bar * M_t) in Hlow by (field; lra).
  lra.
Qed.

(** *** Jumps: the switch to the shadow *)

(** At q_0 = -c the switch takes q to -q; the potential falls by at least
    2 w eta c / sqrt (1 + 2 eta c + eta^2). U_t, of r^2, stays. *)
Theorem jump_falls : forall c q_3,
  0 <= c -> c * c + q_3 * q_3 <= 1 ->
  w * (1 + eta - distance c q_3)
  <= w * (1 + eta - distance (- c) q_3) - 2 * w * eta * c / sqrt (1 + 2 * eta * c + eta * eta).
Proof.
  intros c q_3 Hc Hunit.
  pose proof (distance_squared c q_3) as Ha. pose proof (distance_squared (- c) q_3) as Hb.
  assert (Ha0 : 0 < distance c q_3) by (apply distance_positive; lra).
  assert (Hb0 : 0 <= distance (- c) q_3) by apply sqrt_pos.
  assert (Hec : 0 <= eta * c) by (apply Rmult_le_pos; lra).
  assert (Htop0 : 0 < sqrt (1 + 2 * eta * c + eta * eta)) by (apply sqrt_lt_R0; nra).
  assert (Htop : distance c q_3 <= sqrt (1 + 2 * eta * c + eta * eta)) by (apply sqrt_le_1_alt; nra).
  assert (Hba : distance (- c) q_3 <= distance c q_3) by (apply sqrt_le_1_alt; nra).
  remember (sqrt (1 + 2 * eta * c + eta * eta)) as top eqn:E. clear E.
  remember (distance c q_3) as a eqn:E. clear E.
  remember (distance (- c) q_3) as d eqn:E. clear E.
  assert (Hdiff : (a - d) * (a + d) = 4 * (eta * c)).
  { replace ((a - d) * (a + d)) with (a * a - d * d) by ring. rewrite Ha, Hb. ring. }
  assert (Hgain : 2 * (eta * c) / top <= a - d).
  { apply Rmult_le_reg_r with top; [exact Htop0|].
    replace (2 * (eta * c) / top * top) with (2 * (eta * c)) by (field; lra).
    assert ((a - d) * (a + d) <= (a - d) * (2 * top)) by (apply Rmult_le_compat_l; lra). lra. }
  apply Rmult_le_compat_l with (r := w) in Hgain; [|lra].
  replace (w * (2 * (eta * c) / top)) with (2 * w * eta * c / top) in Hgain by (field; lra).
  lra.
Qed.

End Potential.

(** ** Nothing of the feed-forward works on the error

    omega~ . J omega~' is omega~ . (feedback) alone, for every diagonal J,
    every omega_r = R~^T omega_d and every acceleration a = R~^T omega_d'. *)

Theorem feed_forward_cancels :
  forall j_1 j_2 j_3 e_1 e_2 e_3 r_1 r_2 r_3 a_1 a_2 a_3 f_1 f_2 f_3 n_1 n_2 n_3 : R,
  (* omega = omega~ + omega_r *)
  let o_1 := e_1 + r_1 in let o_2 := e_2 + r_2 in let o_3 := e_3 + r_3 in
  (* tau = J a - [J omega_r]x omega_r - feedback: the code's [torque] *)
  let tau_1 := j_1 * a_1 + (j_3 - j_2) * r_2 * r_3 - f_1 in
  let tau_2 := j_2 * a_2 + (j_1 - j_3) * r_3 * r_1 - f_2 in
  let tau_3 := j_3 * a_3 + (j_2 - j_1) * r_1 * r_2 - f_3 in
  (* J omega' = tau - omega x J omega, and n = omega~' = omega' - a + omega~ x omega_r *)
  j_1 * n_1 = tau_1 - (o_2 * (j_3 * o_3) - o_3 * (j_2 * o_2)) - j_1 * a_1 + j_1 * (e_2 * r_3 - e_3 * r_2) ->
  j_2 * n_2 = tau_2 - (o_3 * (j_1 * o_1) - o_1 * (j_3 * o_3)) - j_2 * a_2 + j_2 * (e_3 * r_1 - e_1 * r_3) ->
  j_3 * n_3 = tau_3 - (o_1 * (j_2 * o_2) - o_2 * (j_1 * o_1)) - j_3 * a_3 + j_3 * (e_1 * r_2 - e_2 * r_1) ->
  e_1 * (j_1 * n_1) + e_2 * (j_2 * n_2) + e_3 * (j_3 * n_3) = - (e_1 * f_1 + e_2 * f_2 + e_3 * f_3).
Proof.
  intros j_1 j_2 j_3 e_1 e_2 e_3 r_1 r_2 r_3 a_1 a_2 a_3 f_1 f_2 f_3 n_1 n_2 n_3
    o_1 o_2 o_3 tau_1 tau_2 tau_3 H_1 H_2 H_3.
  rewrite H_1, H_2, H_3. unfold tau_1, tau_2, tau_3, o_1, o_2, o_3. ring.
Qed.
